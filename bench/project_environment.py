"""Whichever Python starts a bench, it goes on in the project's environment, set up for tests."""

import itertools
import os
import subprocess
import sys
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]
_PYTHON = _ROOT / ".venv" / "bin" / "python"
_ROS2 = _ROOT / ".ros2"
_MARK = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def enter_environment(*, with_nodes: bool = False) -> None:
    """Set the computer up where it is not yet, then start the same script again with the project's Python.

    A bench `with_nodes` of its own goes on with the wheels of ROS 2 where its command line has `--ros 2`.
    Returns where that has happened, with the repository on the path of modules.
    """
    if not (_ROOT / ".venv" / "ready-test").is_file():
        done = subprocess.run(["bash", str(_ROOT / "tools" / "set_up.bash"), "test"], check=False)
        if done.returncode:
            sys.exit(done.returncode)
    python = _PYTHON
    if with_nodes and asks_for_ros2(sys.argv[1:]):
        python = _ROS2 / "bin" / "python"
        if not python.exists():
            sys.exit(f"error: {_ROS2} is missing, expected the wheels of ROS 2, which only x86-64 has")
        os.environ.update({_MARK: "1", "LD_LIBRARY_PATH": (_ROS2 / "libraries").read_text().strip()})
    if Path(sys.executable) != python:
        os.execv(python, [str(python), *sys.argv])
    sys.path.insert(0, str(_ROOT))


def asks_for_ros2(arguments: list[str]) -> bool:
    """Return whether the command line of a bench has `--ros 2`."""
    return "--ros=2" in arguments or ("--ros", "2") in itertools.pairwise(arguments)
