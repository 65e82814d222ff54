"""Facts, log and simulated time of a node of ROS 2."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ur_nodes.ports.log import Throttle

if TYPE_CHECKING:
    from rclpy.clock import JumpHandle
    from rclpy.node import Clock, Logger


class FileFacts:
    """See `ports.facts.Facts`: a file of the run, since ROS 2 has no parameters without a node."""

    def __init__(self, *, simulated_time: bool, file: Path | None = None) -> None:
        self.simulated_time = simulated_time
        self._file = file or file_of_run()

    def get(self, name: str, default: object = None) -> Any:
        """See Facts."""
        return self._read().get(name, default)

    def set(self, name: str, value: object) -> None:
        """See Facts."""
        facts = self._read() | {name: value}
        self._file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        number, new = tempfile.mkstemp(dir=self._file.parent, prefix=".facts")
        with os.fdopen(number, "w") as file:
            json.dump(facts, file)
        Path(new).replace(self._file)

    def _read(self) -> dict[str, object]:
        with contextlib.suppress(OSError, ValueError):
            found = json.loads(self._file.read_text())
            if isinstance(found, dict):
                return found
        return {}


def file_of_run() -> Path:
    """The file of the facts of this run."""
    if given := os.environ.get("UR_FACTS"):
        return Path(given)
    folder = os.environ.get("XDG_RUNTIME_DIR") or Path.home() / ".cache"
    return Path(folder) / "ubiquity_launches" / f"facts-{os.environ.get('ROS_DOMAIN_ID', '0')}.json"


class RosLog:
    """See `ports.log.Log`."""

    def __init__(self, logger: Logger, read: Callable[[], float]) -> None:
        self._logger = logger
        self._throttle = Throttle(read)

    def debug(self, text: str) -> None:
        """See Log."""
        self._logger.debug(text)

    def info(self, text: str) -> None:
        """See Log."""
        self._logger.info(text)

    def warn(self, text: str, *, every: float = 0.0) -> None:
        """See Log."""
        if self._throttle.lets(text, every):
            self._logger.warning(text)

    def error(self, text: str, *, every: float = 0.0) -> None:
        """See Log."""
        if self._throttle.lets(text, every):
            self._logger.error(text)


def follow_clock(clock: Clock, call: Callable[[], None]) -> JumpHandle:
    """Have a call made, on the thread that spins, when a clock has a new time; while the result is kept."""
    from rclpy.clock import JumpThreshold
    from rclpy.duration import Duration

    every = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))
    return clock.create_jump_callback(every, post_callback=lambda _jump: call())
