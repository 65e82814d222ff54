"""Nodes on ROS 2, in a domain of their own; each is a process."""

import os
import subprocess
from pathlib import Path

from ur.system.ros import users_of_domains

ROOT = Path(__file__).parents[1]
PYTHON = ROOT / ".ros2/bin/python"
"""Python with the wheels of ROS 2; missing where there are none for the processor."""

_PATIENCE = 10.0  # s


def free_domain() -> str:
    """A domain in which no node of this computer is."""
    used = users_of_domains()
    return str(next(each for step in range(59) if (each := 1 + (os.getpid() + step) % 59) not in used))


class Ros2Session:
    """Starts nodes; `close` ends those that still run. Logs and facts are in a folder."""

    def __init__(self, folder: Path) -> None:
        self.environment = {
            **os.environ,
            "AMENT_PREFIX_PATH": str(ROOT / ".ros2"),
            "PYTHONPATH": str(ROOT),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_DOMAIN_ID": free_domain(),
            "ROS_LOG_DIR": str(folder),
            "ROS_VERSION": "2",
            "UR_FACTS": str(folder / "facts.json"),
        }
        self._folder = folder
        self._running: list[subprocess.Popen[str]] = []

    def run(self, *arguments: str, within: float) -> subprocess.CompletedProcess[str]:
        """Run a program of Python to its end, at most `within` s."""
        command = [str(PYTHON), *arguments]
        return subprocess.run(
            command, env=self.environment, capture_output=True, text=True, timeout=within, check=False
        )

    def start(self, name: str, module: str, *arguments: str) -> subprocess.Popen[str]:
        """Start a node of ours; what it prints goes to NAME.txt."""
        command = [str(PYTHON), "-m", "ur_nodes", module, f"__name:={name}", *arguments]
        with (self._folder / f"{name}.txt").open("a") as output:
            node = subprocess.Popen(command, env=self.environment, stdout=output, stderr=output, text=True)
        self._running.append(node)
        return node

    def kill(self, node: subprocess.Popen[str]) -> None:
        """End a node without any warning."""
        node.kill()
        node.wait(_PATIENCE)
        self._running.remove(node)

    def close(self) -> None:
        """End all nodes."""
        for node in self._running:
            node.terminate()
        while self._running:
            self._end(self._running.pop())

    @staticmethod
    def _end(node: subprocess.Popen[str]) -> None:
        try:
            node.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            node.kill()
            node.wait()
