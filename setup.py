"""Build and install of impact_predictor, for pip and for colcon."""

import os
import runpy
from importlib.machinery import EXTENSION_SUFFIXES
from multiprocessing.pool import ThreadPool
from pathlib import Path

from setuptools import Extension, find_packages, setup
from setuptools.command.build_ext import build_ext

NAME = "impact_predictor"
SHARE = f"share/{NAME}"

native = runpy.run_path(f"{NAME}/native.py")
LIBRARY = native["library_name"]()


class BuildNative(build_ext):
    """Builds the library of machine code; where that cannot be, the files run as Python."""

    def run(self) -> None:
        if not self.extensions:  # without mypyc, or where IMPACT_PREDICTOR_PLAIN says so
            return
        file = Path(self.get_ext_filename(LIBRARY)).name
        there = [path for path in map(Path, native["libraries"]()) if path.name.endswith(EXTENSION_SUFFIXES[0])]
        if self.inplace and file in [path.name for path in there]:
            return
        for path in there:
            path.unlink()
        try:
            self.make(self.extensions[0])
            super().run()
        except (Exception, SystemExit) as error:  # of mypyc, the compiler, the disk: none ends an install
            self.warn(f"nothing is compiled, the files run as Python: {error}")
            self.extensions = []

    def make(self, library: Extension) -> None:
        """Make the C of the library, of the sources as they are now."""
        from mypyc.build import mypycify

        # The others load a module of the library each, which impact_predictor/native.py does.
        modules = map(os.path.relpath, map(native["file_of"], native["MODULES"]))
        made, *_ = mypycify(
            ["--config-file=tools/mypyc.ini", *modules],
            opt_level="1",
            debug_level="0",
            multi_file=True,
            group_name=LIBRARY.removesuffix("__mypyc"),
            target_dir=self.build_temp,
        )
        library.sources, library.depends, library.include_dirs = made.sources, made.depends, made.include_dirs
        # A product and a sum rounded as one are other numbers than Python's.
        library.extra_compile_args = [*made.extra_compile_args, "-ffp-contract=off", "-fvisibility=hidden"]

    def build_extensions(self) -> None:
        """Compile its files at the same time, on all processors."""
        compile_some = self.compiler.compile

        def compile_all(sources: list[str], *args: object, **named: object) -> list[str]:
            with ThreadPool() as pool:
                made = pool.map(lambda source: compile_some([source], *args, **named), sources)
            return [path for paths in made for path in paths]

        self.compiler.compile = compile_all
        super().build_extensions()


def has_mypyc() -> bool:
    """Whether the modules can be compiled, and are to be."""
    try:
        import mypyc  # noqa: F401
    except ImportError:
        return False
    return not native["is_refused"]()


def files_of(folder: str) -> list[tuple[str, list[str]]]:
    """Every file below a folder, with the place under share/ where it is installed."""
    folders = [Path(folder), *sorted(path for path in Path(folder).rglob("*") if path.is_dir())]
    return [
        (f"{SHARE}/{place.as_posix()}", [path.as_posix() for path in sorted(place.iterdir()) if path.is_file()])
        for place in folders
        if place.name != "__pycache__"
    ]


EXTRAS = {
    "ros": ["ros-jazzy-common-interfaces", "ros-jazzy-rclpy[fastrtps]"],
    # Pictures: figures and maps.
    "plot": ["contourpy>=1.0", "matplotlib>=3.6"],
    "page": ["jinja2>=3.0", "plotly>=6.0"],
    "calibrate": ["scipy>=1.11"],
    # `impact-predictor report`.
    "report": ["jinja2>=3.0", "plotly>=6.0", "scipy>=1.11"],
    "fast": ["numba"],
    # Many bags at a time, and their touchdowns as Parquet.
    "fleet": ["dask>=2024.1", "distributed>=2024.1", "pyarrow>=16"],
    # Pinocchio, for machines with joints.
    "articulated": ["pin>=3.0"],
    # Spectra of waves to compare with.
    "spectra": ["wavespectra>=4.4"],
    "browser": ["playwright>=1.45"],
    # Robots that walk in MuJoCo: `impact-predictor simulate robot`.
    "robot": ["example-robot-data>=4.0", "mujoco>=3.3"],
    "test": ["hypothesis", "mcap-ros2-support>=0.5", "mpmath>=1.3", "pytest", "pytest-xdist"],
}
ALL = ("plot", "page", "calibrate", "fast", "fleet", "articulated", "robot")
"""What brings a command or an option; ROS from PyPI is never mixed with a sourced one, so it is asked for by name."""

setup(
    name=NAME,
    version="1.0.0",
    description="Predicts the next touchdown of a rigid body: when, in which contact mode, with which velocities",
    maintainer="impact_predictor maintainers",
    maintainer_email="maintainers@users.noreply.github.com",
    license="Apache-2.0",
    classifiers=[
        "Framework :: Pytest",
        "Intended Audience :: Science/Research",
        "Operating System :: POSIX :: Linux",
        "Programming Language :: Python :: 3",
        "Topic :: Scientific/Engineering :: Physics",
        "Typing :: Typed",
    ],
    python_requires=">=3.10",
    packages=find_packages(include=[NAME, f"{NAME}.*"]),
    package_data={NAME: ["py.typed"], f"{NAME}.report.page": ["page.css", "page.html"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (SHARE, ["package.xml"]),
        *files_of("config"),
        *files_of("examples"),
        *files_of("launch"),
    ],
    install_requires=[
        "backports.zstd>=1.0; python_version < '3.14'",
        "click>=8.1",
        "librt>=0.16",  # machine code of mypyc works with its vectors
        "lz4>=4.0",
        "mcap>=1.2,<2",
        "mypy_extensions>=1.0",  # and with its integers
        "numpy>=1.26",
        "rich>=13",
        "rosbags>=0.11,<0.12",
        "ruamel.yaml>=0.18",
    ],
    extras_require={**EXTRAS, "all": sorted({one for name in ALL for one in EXTRAS[name]})},
    entry_points={
        "console_scripts": [
            "impact-predictor = impact_predictor.cli:main",
            "predictor = impact_predictor.ros.node:main",
        ],
        "pytest11": ["impact_predictor = impact_predictor.testing.plugin"],
    },
    cmdclass={"build_ext": BuildNative},
    # Its C is made when it is built: an install asks several times what there is to build.
    ext_modules=[Extension(f"{NAME}.{LIBRARY}", [])] if has_mypyc() else [],
    zip_safe=False,
)
