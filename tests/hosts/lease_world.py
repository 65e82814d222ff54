"""Two laptops and a phone that want to drive one robot: their programs, their screens, and what the robot did."""

import re
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from typing import Any

from bench.stop_network_parts.computer import Computer, Waits
from bench.stop_network_parts.lane import Lane
from bench.stop_network_parts.network import BUSY
from tests.hosts.bench import boot, wait_until

_SPACE = "shared"
_LIMIT = 0.35  # s: the longest motion after the end of a lease, and how far two records may be apart
_WINDOW = 1.0  # s before a motion, in which mux and recorder must have had a processor for it to mean anything
_LOOK = 0.1  # s
# Each drives in a way of its own, so that the robot's motion tells who drives it.
_LANES = {
    "laptop": (Lane("keyboard", "linear", 0.3, _SPACE), "held"),
    "laptop2": (Lane("keyboard", "linear", 0.3, _SPACE), "held back"),
    "phone": (Lane("phone", "angular", 0.8, _SPACE), "held"),
}
NAMES = tuple(_LANES)


class LeaseWorld:
    """All of it. Persons hold their keys from the start of their program to its end."""

    def __init__(self, computers: dict[str, Computer]) -> None:
        self._computers = computers
        self.names: dict[str, str] = {}  # of all clients that ever were, by id
        self._waits = Waits()
        self._ended = threading.Event()
        self._looker = threading.Thread(target=self._look, daemon=True)

    @property
    def _robot(self) -> Computer:
        return self._computers["robot"]

    def begin(self) -> None:
        """Start mux and recorder."""
        self._robot.start()
        self._robot.order("master")
        address = f"http://{self._robot.machine.address}:11311"
        self._robot.machine.wait_for("rosparam list", environment={"ROS_MASTER_URI": address})
        pids = {"mux": self._robot.order("mux", lane=asdict(_LANES["laptop"][0]), base="magni")}
        pids["recorder"] = self._robot.order("recorder", lanes=[asdict(_LANES["laptop"][0])])
        self._waits.follow(self._robot.outer(pids))
        self._looker.start()
        for name in ("laptop", "laptop2"):
            self._computers[name].start()
        wait_until(lambda: bool(self.lease()), "a lease")

    def end(self) -> None:
        """End everything but the computers."""
        self._ended.set()
        if self._looker.is_alive():
            self._looker.join()
        for computer in self._computers.values():
            computer.stop()

    def _look(self) -> None:
        while not self._ended.wait(_LOOK):
            self._waits.look()

    def start(self, name: str, conduct: str) -> str:
        """Start a client, with this UR_LEASE; its id."""
        lane, pattern = _LANES[name]
        computer = self._computer(name)
        more = {"UR_CLIENT_NAME": name, "UR_LEASE": conduct}
        identity = str(computer.order("commander", lane=asdict(lane), name=name, more=more))
        computer.order("drive", pattern=pattern, name=name)
        self.names[identity] = name
        return identity

    def press(self, name: str, key: str) -> None:
        """Press a key of a client once."""
        self._computer(name).order("press", name=name, key=key)

    def signal(self, name: str, number: signal.Signals) -> None:
        """Send a signal to a client's programs."""
        self._computer(name).order("signal", name=name, number=int(number))

    def screen(self, name: str) -> list[str]:
        """The lines of a client's screen."""
        return list(self._computer(name).order("screen", name=name))

    def lease(self) -> dict[str, Any]:
        """The lease as the mux published it last; empty before the first."""
        notes = self._robot.read_leases(_LANES["laptop"][0], 0.0)
        return notes[-1].lease if notes else {}

    def list_strangers(self, since: float) -> list[tuple[str, bool]]:
        """Motion since a monotonic time that is not its own driver's: when, whose, and who held the lease.

        The second value says that mux and recorder had to wait for a processor then, so that it means nothing.
        """
        notes = [(note.at, str(note.lease["client"])) for note in self._robot.read_leases(_LANES["laptop"][0], 0.0)]
        ends = [at for at, _ in notes[1:]] + [float("inf")]
        found = []
        for at, forward, turn in self._robot.read_outputs(_LANES["laptop"][0], since):
            moving = {"laptop": forward > 0, "laptop2": forward < 0, "phone": turn > 0, "nobody": turn < 0}
            for name, moves in moving.items():
                holders = {
                    self.names.get(client, client)
                    for (begin, client), end in zip(notes, ends, strict=True)
                    if begin - _LIMIT <= at <= end + _LIMIT
                }
                if moves and name not in holders:
                    waited = sum(self._waits.between(each, at - _WINDOW, at) for each in ("mux", "recorder"))
                    found.append((f"{at:.3f}: moved as {name} drives, lease of {sorted(holders)}", waited > BUSY))
        return found

    def _computer(self, name: str) -> Computer:
        return self._computers["laptop" if name == "phone" else name]


@contextmanager
def start_lease_world() -> Iterator[LeaseWorld]:
    """Boot two laptops and a robot; the phone's program runs on the first laptop."""
    names = ("laptop", "robot", "laptop2")
    with boot(names, with_repository=names, programs=True) as bench:
        master = bench["robot"].address
        computers = {name: Computer(bench[name], master, -15 if name == "robot" else -10) for name in names}
        world = LeaseWorld(computers)
        try:
            world.begin()
            yield world
        finally:
            world.end()


def check_screen(lines: list[str], name: str, identity: str, lease: dict[str, Any], conduct: str) -> str:
    """Return why a client's screen contradicts the lease; empty if it does not."""
    text = "\n".join(lines)
    other = lease["name"]
    took = lease["taken_from"] is not None and lease["taken_from"]["client"] == identity
    mine = lease["client"] == identity
    if name == "phone":
        wanted = {"free": ["free"], "lost": [f"{other} is out of reach"]}.get(
            lease["state"], [f"{other} took over"] if took else [f"{other} drives", f"{other} took over"]
        )
        return "" if text in (["you drive"] if mine else wanted) else f"{text!r}, expected {wanted}"
    clock = f"{_clock(lease['since'])}"
    took_over, drives = f"{other} took over at {clock}", rf"{other} \(\w+\) drives .* since {clock}"
    reach = rf"{other} \(\w+\) drove .* out of reach"
    if mine:
        forbidden, wanted = ["took over at", "drives .* since", "out of reach"], ["▲ driving"]
    elif lease["state"] == "free":
        forbidden = ["took over at", "drives .* since", "out of reach"]
        wanted = ["no client drives"] if conduct == "watch" else [""]
    elif lease["state"] == "lost":
        forbidden, wanted = ["▲ driving", "took over at", "drives .* since"], [reach]
    else:
        forbidden, wanted = ["▲ driving", "out of reach"], [took_over if took else f"{took_over}|{drives}"]
    wrong = [each for each in forbidden if re.search(each, text)]
    missing = [each for each in wanted if not re.search(each, text)]
    return f"{text!r}, expected {missing or wanted}, and none of {wrong}" if wrong or missing else ""


def _clock(unix: float) -> str:
    return time.strftime("%H:%M", time.gmtime(unix))
