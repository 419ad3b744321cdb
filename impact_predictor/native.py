"""Machine code in the place of Python: the same modules, made of the same files by mypyc.

`make compiled` builds one library of all MODULES, and so does every install where there is a C compiler. Its name has
the digest of the sources that it was made of, so that it never runs in the place of others: where they differ, and
where IMPACT_PREDICTOR_PLAIN is set, the files run as Python.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from importlib.machinery import EXTENSION_SUFFIXES, ModuleSpec
from types import ModuleType

PACKAGE = "impact_predictor"
FOLDER = os.path.dirname(os.path.abspath(__file__))  # noqa: PTH100, PTH120  every start waits for what this imports
PREFIX = "native_"

_COMPILED = {
    "mechanics.impact": "answer contacts path_law rates restitution solve spatial_body spatial_path total_law",
    "mechanics.motion": (
        "engine equations events falling felt integrate phases pivot reactions slip spatial spatial_problem stances"
    ),
    "prediction": (
        "checks course cylinder drawn foot impact motion_recorder planar points predictor recorded scatter score "
        "spatial spatial_impact vectors"
    ),
    "prediction.deck": "frame motion tracker window",
    "prediction.walking": (
        "announcement base braking clock cubic descent doubts feet forces ground impact landings machine point_filter "
        "rest rhythm schedule stance terrain trajectory"
    ),
    "prediction.watch": "stance standing",
    "ros": "cdr",
    "ros.messages": "fields kinds message",
}
MODULES = tuple(f"{PACKAGE}.{folder}.{name}" for folder, names in _COMPILED.items() for name in names.split())
"""What is compiled: the impact laws, and what a sample goes through. What takes arrays and what tests stand in for runs
as Python, as does what numba reads (`as_python`)."""

FOLDERS = ("mechanics", "prediction", "ros/messages")
"""Where the sources of MODULES are, with all that they use: types and constants of others are in the machine code."""

FILES = ("errors", "native", "ros.cdr", "stamps")
"""Modules outside of them on which the library depends: the list of MODULES, too."""


def is_refused() -> bool:
    """Whether IMPACT_PREDICTOR_PLAIN says that nothing is to be compiled, or to run compiled."""
    return os.environ.get("IMPACT_PREDICTOR_PLAIN", "") not in ("", "0")


def file_of(name: str) -> str:
    """The source of a module."""
    return os.path.join(FOLDER, *name.split(".")[1:]) + ".py"  # noqa: PTH118


def sources() -> Iterator[str]:
    """What the library depends on."""
    yield from (file_of(f"{PACKAGE}.{name}") for name in FILES)
    for one in FOLDERS:
        for folder, _, names in os.walk(os.path.join(FOLDER, one)):  # noqa: PTH118
            yield from (os.path.join(folder, name) for name in names if name.endswith(".py"))  # noqa: PTH118


def library_name() -> str:
    """The name that mypyc gives the library of the sources as they are now."""
    from importlib.util import source_hash

    text = []
    for path in sorted(sources()):
        with open(path, "rb") as file:  # noqa: PTH123
            text.append(file.read())
    return f"{PREFIX}{source_hash(b''.join(text)).hex()}__mypyc"


def libraries() -> list[str]:
    """The files of libraries that were built into the package."""
    return [os.path.join(FOLDER, name) for name in os.listdir(FOLDER) if name.startswith(PREFIX)]  # noqa: PTH118, PTH208


@cache
def library() -> ModuleType | str:
    """The library of these sources for this Python, loaded; or why there is none."""
    if is_refused():
        return "IMPACT_PREDICTOR_PLAIN is set"
    built = [path for path in libraries() if path.endswith(EXTENSION_SUFFIXES[0])]
    if not built:
        return "nothing was compiled for this Python"
    name = library_name()
    found = [path for path in built if os.path.basename(path) == name + EXTENSION_SUFFIXES[0]]  # noqa: PTH119
    if not found:
        return "what was compiled is of other sources: `make compiled` compiles these"
    from importlib.util import module_from_spec, spec_from_file_location

    spec = spec_from_file_location(name, found[0])
    assert spec is not None
    assert spec.loader is not None
    try:
        import_module("librt.vecs")  # without its vectors some of the modules could not be loaded, later
        loaded = module_from_spec(spec)
        spec.loader.exec_module(loaded)
    except (ImportError, OSError) as error:
        return f"what was compiled cannot be loaded: {error}"
    # Where its modules look for it.
    sys.modules[name] = loaded
    return loaded


def is_compiled(name: str) -> bool:
    """Whether a module runs as machine code."""
    return name in MODULES and not isinstance(library(), str)


class Finder:
    """Finds and loads MODULES in the library, if there is one."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        if not is_compiled(name):
            return None
        return ModuleSpec(name, self, origin=file_of(name))  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        from ctypes import PYFUNCTYPE, c_char_p, c_void_p, py_object, pythonapi

        found, made_by = library(), f"init_{spec.name.replace('.', '___')}"
        assert isinstance(found, ModuleType)
        pointer = pythonapi.PyCapsule_GetPointer
        pointer.restype, pointer.argtypes = c_void_p, (py_object, c_char_p)
        init = pointer(getattr(found, made_by), f"{found.__name__}.{made_by}".encode())
        return PYFUNCTYPE(py_object)(init)()  # type: ignore[no-any-return]

    def exec_module(self, module: ModuleType) -> None:
        """Nothing: a module of mypyc is executed when it is made."""


def form() -> str:
    """How the modules run, for a reader: compiled, or as Python and why."""
    found = library()
    return f"as Python: {found}" if isinstance(found, str) else "compiled"


def as_python(name: str, family: str = "python") -> ModuleType:
    """A module of the package as Python, whatever was compiled, and with it all that it imports from the package.

    The modules of a `family` are loaded once, and are others than those of another family and of the package. Those of
    the first are there in either form, for numba keeps what it compiled with their names.
    """
    top = f"{PACKAGE}_{family}"
    if top not in sys.modules:
        sys.modules[top] = package = ModuleType(top)
        package.__path__ = [FOLDER]
    return import_module(f"{top}.{name}")


sys.meta_path.insert(0, Finder())
