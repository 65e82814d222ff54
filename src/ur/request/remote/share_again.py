"""Restart of a robot's share of a run after the robot's restart, with a report of the reason for a failure."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from ur.robot.ssh.address import Address
from ur.robot.ssh.openssh import connect
from ur.run.master.client import DEFAULT_PORT, Master
from ur.run.master.monitor import watch_link
from ur.run.master.xml_rpc import Unanswered
from ur.run.output.messages import LossLines, describe_link
from ur.run.supervisor.events import Event, LinkLost, LinkRestored
from ur.source.diagnostic import UserError

LIMIT = 180.0  # s for a robot to restart and to start its nodes
MASTER_LIMIT = 30.0  # s for its master alone: a service that keeps one running has started another by then
PAUSE = 1.0  # s between two tries
_SCRIPT = """\
read -r up _ </proc/uptime
set -- $(sed 's/.*) //' /proc/1/stat)
echo "$up ${20} $(getconf CLK_TCK) $(systemctl is-system-running 2>/dev/null)"
"""


@dataclass(frozen=True, slots=True)
class Health:
    """The time since a robot booted (s), whether it is shutting down, and whether a ROS master answers on it."""

    age: float
    stopping: bool
    master: bool = False


@dataclass(slots=True)
class ShareAgain:
    """Restarts a share.

    `begin` requests it from the robot, and returns the id of its run, and the reason of a failure or ''.

    `examine` and `begin` raise UserError while the robot cannot be reached. `age` is that of this run (s); `command` is
    the command that starts everything again.
    """

    robot: str
    examine: Callable[[], Health]
    begin: Callable[[], tuple[str, str]]
    age: Callable[[], float]
    command: str
    clock: Callable[[], float] = time.monotonic
    pause: float = PAUSE
    run: str = ""  # the id of the run that was started again
    over: threading.Event = field(default_factory=threading.Event)
    _busy: threading.Lock = field(default_factory=threading.Lock)

    def start(self) -> str:
        """Restart the share once the robot has restarted, or has a master again; return '' or the reason of a failure.

        If the master does not return although the robot did not restart, a user has ended it, and it is not restarted.
        """
        begun = self.clock()
        problem = "it does not answer"
        while (now := self.clock()) < begun + LIMIT and not self.over.is_set():
            try:
                health = self.examine()
                if not health.stopping and (health.master or health.age < self.age()):
                    problem = self._begin_unless_over()
                    return self._explain(f"its nodes do not start again: {problem}") if problem else ""
                problem = "it is shutting down" if health.stopping else "it has no ROS master"
                if not health.stopping and now >= begun + MASTER_LIMIT:
                    break
            except UserError as failed:
                problem = failed.diagnostics[0].message
            self.over.wait(self.pause)
        return self._explain(f"its nodes were not started again: {problem}")

    def has_restarted(self) -> bool:
        """Return whether the robot has restarted since this run began. False while the robot does not answer."""
        try:
            return self.examine().age < self.age()
        except UserError:
            return False

    def close(self) -> None:
        """Prevent further starts; return once no start is in progress."""
        self.over.set()
        if self._busy.acquire(timeout=LIMIT):
            self._busy.release()

    def _begin_unless_over(self) -> str:
        with self._busy:
            if self.over.is_set():
                return "the run ends"
            self.run, problem = self.begin()
            return problem

    def _explain(self, what: str) -> str:
        return f"{self.robot}: {what}\n  help: start them again: {self.command}"


def examine_robot(address: Address) -> Health:
    """Inspect a robot over ssh. Raises UserError."""
    with connect(address) as shell:
        done = shell.run(_SCRIPT, timeout=10.0)
    return replace(parse_health(done.out), master=_has_master(address.host))


def _has_master(host: str) -> bool:
    try:
        Master(f"http://{host}:{DEFAULT_PORT}", host, DEFAULT_PORT).get_run_id()
    except Unanswered:
        return False
    return True


def parse_health(text: str) -> Health:
    """Parse the output of the script. A robot with an unreadable answer counts as running forever."""
    try:
        uptime, started, rate, *state = text.split()
        return Health(float(uptime) - float(started) / float(rate), state == ["stopping"])
    except (ValueError, ZeroDivisionError):
        return Health(float("inf"), stopping=False)


class LinkReporter:
    """Prints changes of the link to a robot while a run without nodes on this computer is followed."""

    def __init__(self, robot: str, host: str, report: Callable[[str], None]) -> None:
        self._robot, self._report = robot, report
        self._lines = LossLines()
        self._reachable = threading.Event()
        self._reachable.set()
        self._over = threading.Event()
        master = Master(f"http://{host}:{DEFAULT_PORT}", host, DEFAULT_PORT)
        self._thread = threading.Thread(target=watch_link, args=(master, self._on_event, self._over), daemon=True)

    def __enter__(self) -> LinkReporter:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()

    def wait_reachable(self, pause: float) -> None:
        """Wait a little, and then until the robot answers."""
        time.sleep(pause)
        while not self._reachable.wait(1.0):
            pass

    def _on_event(self, event: Event) -> None:
        if not isinstance(event, (LinkLost, LinkRestored)):
            return
        lost = isinstance(event, LinkLost)
        if lost:
            self._reachable.clear()
        else:
            self._reachable.set()
        if self._lines.is_due(event.seconds, lost=lost):
            self._report(describe_link(self._robot, event.seconds, lost=lost))
