"""The nodes that are measured: in a master or domain of their own, ended by process id."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil
from bench.either_ros import master_answers, node_name, select_ros

from ur.robot.base import Base, load_base
from ur.robot.base.files import find_base_package

ROOT = Path(__file__).resolve().parents[2]
MAPS = ROOT / "ubiquity_launches" / "n_map_server" / "maps"
UPSTREAM = {"stage_ros": "stage_ros", "map_server": "map_server", "amcl": "amcl", "move_base": "move_base"}


@dataclass(frozen=True, slots=True)
class Peers:
    """Which upstream packages take the place of ours."""

    stage: bool = False
    map_server: bool = False
    amcl: bool = False
    move_base: bool = False


@dataclass(frozen=True, slots=True)
class Usage:
    """What a node used: CPU seconds and resident memory in MB."""

    cpu: float
    memory: float


def find_upstream() -> tuple[Peers, list[str]]:
    """Which of the upstream packages are installed, and the names of those that are not."""
    import rospkg

    packages = rospkg.RosPack()
    known = set(packages.list())
    missing = [name for name in UPSTREAM if name not in known]
    peers = Peers("stage_ros" in known, "map_server" in known, "amcl" in known, "move_base" in known)
    return peers, missing


def load_robot(name: str) -> Base:
    """`BASE[:VARIANT]`. Raises UserError: there is none."""
    base, _, variant = name.partition(":")
    return load_base(find_base_package(ROOT / "ubiquity_launches", base, os.environ), base, variant)


class Stack:
    """The nodes of a launch file, started by plain roslaunch with a master, on ROS 2 by `ur launch`.

    A context manager: everything has ended at its end. `name` is that of its files in `directory`; `extra` goes into
    the environment of the nodes.
    """

    def __init__(
        self, name: str, launch: str, directory: Path, extra: Mapping[str, str] | None = None, *, ros: str = "1"
    ) -> None:
        file = directory / f"{name}.launch"
        file.write_text(launch, encoding="utf-8")
        self._environment = select_ros(ros, directory) | dict(extra or {})
        command = [str(ROOT / "ur"), "launch", str(file)]
        if ros == "1":
            command = ["/usr/bin/roslaunch", "-p", self._environment["ROS_MASTER_URI"].rpartition(":")[2], str(file)]
        self._log = (directory / f"{name}.log").open("wb")
        self._process = subprocess.Popen(
            command,
            env=self._environment,
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

    def __enter__(self) -> Stack:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(30)
        except subprocess.TimeoutExpired:
            for child in psutil.Process(self._process.pid).children(recursive=True):
                child.kill()
            self._process.kill()
            self._process.wait(5)
        self._log.close()

    def wait_for(self, what: str, condition: Callable[[], bool], seconds: float = 60.0) -> None:
        """Wait until a condition holds. Raises SystemExit, with the end of the log, when it never does."""
        deadline = time.monotonic() + seconds
        while not condition():
            if self._process.poll() is not None or time.monotonic() > deadline:
                tail = "\n".join(self.output()[-15:])
                raise SystemExit(f"error: {what} did not appear within {seconds:.0f} s, expected it sooner\n{tail}")
            time.sleep(0.1)

    def wait_for_end(self, seconds: float) -> bool:
        """Wait until the nodes have ended by themselves; return whether they have within this time."""
        try:
            self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return False
        return True

    def output(self) -> list[str]:
        """Return the lines that the nodes have printed so far."""
        return Path(self._log.name).read_text(errors="replace").splitlines()

    def master_answers(self) -> bool:
        """Return whether the master, where one is needed, listens."""
        return master_answers(self._environment)

    def usage(self) -> dict[str, Usage]:
        """Return that of each node that was started, and of the master."""
        found: dict[str, Usage] = {}
        for child in psutil.Process(self._process.pid).children(recursive=True):
            with suppress(psutil.NoSuchProcess):
                name = node_name(child.cmdline())
                times = child.cpu_times()
                if name:
                    found[name] = Usage(times.user + times.system, child.memory_info().rss / 1e6)
        return found
