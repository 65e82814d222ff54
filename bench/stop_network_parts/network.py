"""A booted laptop and robot with all lanes on them, and one trial of a cause with all of them at once."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path

from bench.stop_network_parts.computer import Computer, Waits, put_first
from bench.stop_network_parts.lane import COMMANDERS, GOALS, Lane
from bench.stop_network_parts.verdict import Moving, Verdict, is_at_rest, judge, simulate_base
from tests.hosts.bench import boot, wait_until

from ur.robot.base import Base, load_base
from ur_nodes.motion.admission.probation import TOO_CLOSE
from ur_nodes.motion.challenge.freshness import FRESHNESS

LIBRARY = Path(__file__).resolve().parents[2] / "ubiquity_launches"
_ROBOT_NICE, _LAPTOP_NICE = -15, -10
_LOOK = 0.05  # s: how often it is noted how long processes have waited
_AFTER = 1.0  # s: what is looked at after nothing can arrive any more, beside the limit of the slowest lane
BUSY = (
    0.06  # s that a mux and the recorder may wait for a processor, of the half second before the longest motion ended
)
_WINDOW = 0.5  # s
_BEFORE = 4.0  # s: a robot may be on its way to its goal when a trial begins; longer than the limit of that lane
_REST = 1.0  # s: how long nothing may have driven a base before a trial begins, longer than a base brakes
_NAVIGATING_BASE = "stage"  # has a lidar
_PATIENCE = 60.0  # s: for all lanes to drive, and to be at rest
_STEADY = 600  # commands at the rhythm that a mux expects, after which a lane has to drive


@dataclass(frozen=True, slots=True)
class Trial:
    """One trial of a lane. `waited`: how long mux and recorder waited for a processor when it mattered, s.

    `ghost_waits`: the same before the beginning of each ghost.
    `again`: when the base moved again after the network came back, s; None when it did not or that is not the point.
    """

    cause: str
    lane: Lane
    pattern: str
    verdict: Verdict
    waited: float
    commands: int
    again: float | None
    ghost_waits: tuple[float, ...] = ()

    @property
    def disturbed(self) -> bool:
        """Return whether the computer was too busy for the longest motion to mean anything."""
        return self.waited > BUSY

    @property
    def counts(self) -> bool:
        """Return whether its longest motion counts: there is a record of what was sent, and the computer was free."""
        return self.verdict.recorded and not self.disturbed


@dataclass(frozen=True, slots=True)
class Cause:
    """`happen` during a trial, `before` and `after` it. `lost`: the commanders are gone after it.

    Only the lanes of `commanders` have a trial, if those are given, and persons keep to `pattern`.
    """

    title: str
    happen: Callable[..., None]
    lost: bool = False
    before: Callable[[Network], None] | None = None
    after: Callable[[Network], None] | None = None
    commanders: tuple[str, ...] = ()
    pattern: str = ""

    def concerns(self, lane: Lane) -> bool:
        """Return whether a lane has a trial of it."""
        return not self.commanders or lane.commander in self.commanders


class Network:
    """The computers and what runs on them."""

    def __init__(
        self,
        laptop: Computer,
        robot: Computer,
        base_name: str,
        lanes: Sequence[Lane],
        seed: int,
        second: Computer | None = None,
        patience: float = _PATIENCE,
    ) -> None:
        self._patience = patience
        self.laptop = laptop
        self.second = second
        self.robot = robot
        self.lanes = tuple(lanes)
        self.chance = random.Random(seed)
        self.base_name = base_name
        self.base: Base = load_base(LIBRARY, base_name, "")
        self.waits = Waits()
        self.second_clients: set[str] = set()  # ids
        self.back_at: float | None = None
        self._ended = threading.Event()
        self._looker = threading.Thread(target=self._look, daemon=True)

    def start(self) -> None:
        """Start everything."""
        self.restart()
        self._looker.start()

    def close(self) -> None:
        """End everything but the computers."""
        self._ended.set()
        if self._looker.is_alive():
            self._looker.join()
        for computer in (self.laptop, self.robot, self.second):
            if computer:
                computer.stop()

    def get_second(self) -> Computer:
        """The second laptop. Raises LookupError where none was booted."""
        if self.second is None:
            raise LookupError("no second laptop, expected start_network(..., second=True)")
        return self.second

    def start_robot(self) -> None:
        """Start master, muxes and recorder, in place of earlier ones."""
        self.robot.start()
        self.robot.order("master")
        self.robot.machine.wait_for(
            f"ROS_MASTER_URI=http://{self.robot.machine.address}:11311 rosparam list", deadline=30
        )
        plain = [lane for lane in self.lanes if lane.commander != GOALS]
        pids = {lane.name: self.robot.order("mux", lane=asdict(lane), base=self.base_name) for lane in plain}
        pids["recorder"] = self.robot.order("recorder", lanes=[asdict(lane) for lane in self.lanes])
        if len(plain) < len(self.lanes):
            self.robot.order("navigation", base=_NAVIGATING_BASE)
        numbers = self.robot.outer(pids)
        put_first(numbers.values())
        self.waits.follow(numbers)

    def start_laptop(self) -> None:
        """Start the commanders, in place of earlier ones."""
        self.laptop.start()
        for lane in self.lanes:
            self.laptop.order("commander", lane=asdict(lane))

    def restart(self) -> None:
        """Start all programs on both computers, in place of earlier ones."""
        self.start_robot()
        self.start_laptop()

    def recover(self) -> None:
        """Start all anew after a trial that broke off."""
        for computer in (self.laptop, self.robot, self.second):
            if computer:
                computer.machine.restore()
                computer.resume()
        self.restart()

    def run(
        self, cause: str, pattern: str, happen: Callable[[Network], None], commanders: Sequence[str] = ()
    ) -> list[Trial]:
        """One trial of all lanes: drive, let the cause happen, look on until nothing can arrive any more, and judge.

        Only the lanes of some commanders are judged, if those are given. Raises RuntimeError when the lanes are not at
        rest before, or do not drive.
        """
        self._wait_at_rest()
        began = time.monotonic()
        self.laptop.order("drive", pattern=pattern)
        self._wait_driving(began)
        since = time.monotonic()
        self.back_at = None
        happen(self)
        self.laptop.wait_sent(self.robot.machine.address, 180.0)
        time.sleep(_AFTER + max(lane.limit for lane in self.lanes))
        end = time.monotonic()
        trials = [self._judge(cause, pattern, lane, (began, since, end)) for lane in self._select(commanders)]
        with suppress(RuntimeError):
            self.laptop.order("drive", pattern="")
        return trials

    def _judge(self, cause: str, pattern: str, lane: Lane, times: tuple[float, float, float]) -> Trial:
        began, since, end = times
        if lane.commander == GOALS:  # a goal is a command for as long as its client takes part in the lease
            commands = [(beat.monotonic, 1.0, 0.0) for beat in self.laptop.read_beats(lane, began - _BEFORE)]
            motion = [Moving(each.at, each.moves, 0) for each in self.robot.read_truth(lane, began)]
        else:
            commands = self._commands(lane, began - _REST)
            motion = simulate_base(self.base, self.robot.read_outputs(lane, began), end)
        verdict = judge(lane, commands, motion, since)
        waited = self._waited(lane, verdict.at)
        again = None
        if self.back_at is not None:
            again = next((m.at - self.back_at for m in motion if m.at >= self.back_at and (m.forward or m.turn)), None)
        ghost_waits = tuple(self._waited(lane, ghost.began) for ghost in verdict.ghosts)
        return Trial(cause, lane, pattern, verdict, waited, len(commands), again, ghost_waits)

    def _waited(self, lane: Lane, at: float) -> float:
        """Return how long mux and recorder waited for a processor shortly before a time, s."""
        return sum(self.waits.between(name, at - _WINDOW, at) for name in (lane.name, "recorder"))

    def _select(self, commanders: Sequence[str]) -> list[Lane]:
        return [lane for lane in self.lanes if not commanders or lane.commander in commanders]

    def _commands(self, lane: Lane, since: float) -> list[tuple[float, float, float]]:
        """Those of the laptop, but while the second laptop has the lease those of that one."""
        own = [sent[1:] for sent in self.laptop.read_sent(lane, since)]
        if self.second is None or not (others := self.second.read_sent(lane, since)):
            return own
        notes = [(note.at, note.lease["client"] in self.second_clients) for note in self.robot.read_leases(lane, since)]

        def has_lease(at: float) -> bool:
            return next((theirs for begin, theirs in reversed(notes) if begin <= at), False)

        fresh = [sent[1:] for sent in others if has_lease(sent.monotonic)]
        return [each for each in own if not has_lease(each[0])] + fresh

    def _wait_at_rest(self) -> None:
        """Wait until no base is driven any more: what moved before the records would seem to move on its own."""
        moving: list[str] = []
        plain = [lane for lane in self.lanes if lane.commander != GOALS]

        def rest() -> bool:
            since = time.monotonic() - _REST
            moving[:] = [lane.name for lane in plain if not is_at_rest(self.robot.read_outputs(lane, since), since)]
            return not moving

        try:
            wait_until(rest, "all lanes are at rest", self._patience)
        except AssertionError:
            raise RuntimeError(f"is not at rest: {', '.join(moving)}") from None

    def _wait_driving(self, began: float) -> None:
        waiting = {lane.name for lane in self.lanes}

        def drive() -> bool:
            for lane in self.lanes:
                if any(any(output[1:]) for output in self.robot.read_outputs(lane, began)):
                    waiting.discard(lane.name)
            return not waiting

        while not drive():
            if failed := [lane.name for lane in self.lanes if lane.name in waiting and self._has_failed(lane, began)]:
                raise RuntimeError(f"does not drive: {', '.join(failed)}\n{self.laptop.log()}\n{self.robot.log()}")
            time.sleep(_LOOK)

    def _has_failed(self, lane: Lane, began: float) -> bool:
        """Return whether a lane was patiently waited for: it sends nothing, or has sent enough as a mux expects it.

        On a busy computer commands are late, and a mux rightly ignores those that are.
        """
        sent = [each.monotonic for each in self.laptop.read_sent(lane, began)]
        steady = sum(TOO_CLOSE <= after - before <= FRESHNESS for before, after in pairwise(sent))
        now = time.monotonic()
        silent = now - (sent[-1] if sent else began) > self._patience
        return now - began > self._patience and (silent or steady >= _STEADY)

    def _look(self) -> None:
        while not self._ended.wait(_LOOK):
            self.waits.look()


def make_lanes(base: Base, commanders: Sequence[str] = COMMANDERS) -> list[Lane]:
    """A linear and an angular lane of each commander, at the full speed of a base."""
    goals = [Lane(GOALS, "linear", base.limits.velocity)] if GOALS in commanders else []
    return goals + [
        lane
        for commander in commanders
        if commander != GOALS
        for lane in (
            Lane(commander, "linear", base.limits.velocity),
            Lane(commander, "angular", base.limits.angular_velocity),
        )
    ]


@contextmanager
def start_network(
    base_name: str, commanders: Sequence[str] = COMMANDERS, seed: int = 1, *, second: bool = False
) -> Iterator[Network]:
    """Boot a laptop, a robot and if asked for a second laptop, start all lanes, and remove everything at the end."""
    names = ("laptop", "robot", *(("laptop2",) if second else ()))
    with boot(names, with_repository=names, programs=True) as bench:
        address = bench["robot"].address
        network = Network(
            Computer(bench["laptop"], address, _LAPTOP_NICE),
            Computer(bench["robot"], address, _ROBOT_NICE),
            base_name,
            make_lanes(load_base(LIBRARY, base_name, ""), commanders),
            seed,
            Computer(bench["laptop2"], address, _LAPTOP_NICE) if second else None,
        )
        try:
            network.start()
            yield network
        finally:
            network.close()
