"""A robot that boots with control groups of version 2 alone, the trials on it, and their table."""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from tests.hosts.bench import REPOSITORY, Machine, boot
from tests.hosts.conftest import SUDO

LIMIT = 0.3  # s
USERS = ("root", "pat")
STARTERS = ("socket", "manager")
"""Who starts guards in units of their own: the units of `ur boot install`, or the systemd of the user (of root)."""
_UNIFIED = "SYSTEMD_NSPAWN_UNIFIED_HIERARCHY"


@dataclass(frozen=True, slots=True)
class Trial:
    """A set that was killed at once, and the time (s) from then until the motors of each board rested; None: never."""

    chosen: str
    rest: Mapping[str, float | None]

    @property
    def longest(self) -> float:
        """The longest time; infinite where a board drove on."""
        return max(float("inf") if each is None else each for each in self.rest.values())


@contextmanager
def boot_robot() -> Iterator[Machine]:
    """Boot it, with this repository."""
    before = os.environ.get(_UNIFIED)
    os.environ[_UNIFIED] = "1"
    try:
        with boot(("robot",), with_repository=("robot",), programs=True) as bench:
            bench["robot"].write("/etc/sudoers.d/pat", SUDO, mode=0o440)
            yield bench["robot"]
    finally:
        os.environ.pop(_UNIFIED)
        if before is not None:
            os.environ[_UNIFIED] = before


def run_trials(robot: Machine, user: str, starter: str, count: int, sets: Sequence[str] = ()) -> Iterator[Trial]:
    """Kill each set so often, all sets without any; see `trials`. Raises RuntimeError with what it said at its end."""
    words = f"{user} {starter} {count} {' '.join(sets)}"
    environment = {"PYTHONPATH": f"{REPOSITORY}/src:{REPOSITORY}", "PYTHONDONTWRITEBYTECODE": "1"}
    command = f"cd {REPOSITORY} && exec .venv/bin/python -m bench.motor_guard_parts.trials {words}"
    with robot.spawn(command, environment=environment) as running:
        assert running.stdout
        rest = []
        for line in running.stdout:
            if line.startswith("{"):
                found = json.loads(line)
                yield Trial(found["set"], found["rest"])
            else:
                rest.append(line)
    if running.returncode:
        raise RuntimeError("".join(rest[-40:]))
