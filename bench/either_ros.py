"""The ROS that a bench starts nodes on: a master, or a domain of ROS 2, that it has for itself."""

import os
import socket
import subprocess
from collections.abc import Iterable
from pathlib import Path

from tests.e2e.conftest import make_environment
from tests.e2e.matrix_ros2 import ros2_environment
from tests.ros2_session import free_domain

ROOT = Path(__file__).resolve().parents[1]
_OF_THIS_PYTHON = ("LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
_PREFIXES = ("__name:=", "__node:=")


def select_ros(version: str, folder: Path) -> dict[str, str]:
    """Choose a free master or domain, for the nodes of this process, too; return the environment of programs.

    Their home is in `folder`; on ROS 2 `ur use sim --ros 2` has been called in it.
    """
    environment = make_environment(folder) | {
        "XDG_STATE_HOME": str(folder / "state"),
        "XDG_RUNTIME_DIR": str(folder / "run"),
    }
    for name in _OF_THIS_PYTHON:
        environment.pop(name, None)
    if version == "2":
        environment = {name: value for name, value in environment.items() if not name.startswith("ROS_")}
        command = [str(ROOT / "ur"), "use", "sim", "--ros", "2"]
        subprocess.run(command, env=environment, capture_output=True, check=True)
        environment |= ros2_environment(folder, free_domain())
    for name in [name for name in os.environ if name.startswith("ROS_")]:
        del os.environ[name]
    os.environ.update({name: value for name, value in environment.items() if _is_of_ros(name)})
    return environment


def _is_of_ros(name: str) -> bool:
    return name.startswith(("ROS_", "AMENT_", "UR_FACTS"))


def start_master(environment: dict[str, str]) -> subprocess.Popen[bytes] | None:
    """Start the master of an environment; None: ROS 2 has none."""
    if environment.get("ROS_VERSION") == "2":
        return None
    port = environment["ROS_MASTER_URI"].rpartition(":")[2]
    return subprocess.Popen(["rosmaster", "--core", "-p", port], env=environment, stdout=subprocess.DEVNULL)


def master_answers(environment: dict[str, str]) -> bool:
    """Return whether the master of an environment listens; ROS 2 needs none."""
    if environment.get("ROS_VERSION") == "2":
        return True
    port = int(environment["ROS_MASTER_URI"].rpartition(":")[2])
    with socket.socket() as probe:
        return probe.connect_ex(("localhost", port)) == 0


def node_name(command: Iterable[str]) -> str:
    """The name of a node by its command line; "": it is none, "(master)": that is what it is."""
    words = list(command)
    for word in words:
        for prefix in _PREFIXES:
            if word.startswith(prefix):
                return word.removeprefix(prefix)
    return "(master)" if any(word.endswith("rosmaster") for word in words) else ""
