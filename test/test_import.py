import subprocess
import sys

HEAVY = {"matplotlib", "numba", "rclpy", "rosbags", "scipy"}


def test_importing_the_library_loads_neither_ros_nor_what_only_some_commands_need():
    code = f"import sys, impact_predictor; impact_predictor.solve_impact; print(*({HEAVY} & sys.modules.keys()))"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert loaded.stdout.split() == []
