"""Random histories of a first drive: scans are lost, tf is late, goals and people come and go, nodes are started anew.

Whatever happened, the base is at rest `REST` after the last command has reached the mux, or after an emergency stop.
"""

import random
from dataclasses import dataclass

from tests.ur_nodes.first_drive.drive import STARTS, FirstDrive

from ur_nodes.memory.bus import Bus
from ur_nodes.ports.actions import GoalId
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Twist

REST = 0.3
"""s"""
_SPEED, _TURN = 0.01, 0.02  # m/s, rad/s: what counts as rest, as in bench/stop
_COMMANDS = ("_vel", "_vel_stamped")  # ends of the names of topics that drive
_TROUBLED = ("/scan", "/tf", "/odom", "/map", "/amcl_pose", "/initialpose", "/cmd_vel_mux/challenge")


class Troubles:
    """What happens to values on their way: each topic may be lost or late for a while."""

    def __init__(self, random_: random.Random) -> None:
        self._random = random_
        self._until: dict[str, tuple[int, float | None]] = {}
        self.bus: Bus | None = None
        self.silent = False
        """No command reaches the mux any more."""

    def begin(self, topic: str, seconds: float, late: float | None) -> None:
        """Lose what is sent on a topic for so long, or deliver it up to `late` s later."""
        assert self.bus
        self._until[topic] = (self.bus.now + round(seconds * 1e9), late)

    def delay(self, topic: str) -> int | None:
        """See Bus."""
        if self.silent and topic != "/cmd_vel" and topic.endswith(_COMMANDS):
            return None
        until, late = self._until.get(topic, (0, 0.0))
        if self.bus is None or self.bus.now >= until:
            return 0
        return None if late is None else self._random.randrange(round(late * 1e9) + 1)


@dataclass(frozen=True, slots=True)
class Ended:
    """The end of a history: what was wrong, '' for nothing, and whether the base drove when commands ended."""

    problem: str
    moving: bool


def run_history(seed: int) -> Ended:
    """Run one. Raises what a node raises."""
    random_ = random.Random(seed)
    troubles = Troubles(random_)
    drive = FirstDrive(seed=seed, delay=troubles.delay)
    troubles.bus = drive.bus
    cancels = drive.client.publish("move_base/cancel", GoalId, Quality.EVERY)
    told = []
    for _ in range(random_.randint(4, 12)):
        event = random_.choice(("goal", "goal", "goal", "cancel", "trouble", "trouble", "hand", "stop", "restart"))
        told.append(event)
        if event == "goal":
            drive.send_goal(random_.uniform(-1.0, 5.0), random_.uniform(-1.0, 3.0), random_.uniform(-3.0, 3.0))
        elif event == "cancel":
            cancels.send(GoalId())
        elif event == "trouble":
            late = random_.choice((None, 0.05, 0.5))
            troubles.begin(random_.choice(_TROUBLED), random_.uniform(0.1, 3.0), late)
        elif event == "hand":
            forward, turn = random_.uniform(-0.5, 0.5), random_.uniform(-1.0, 1.0)
            drive.drive(forward, turn, random_.uniform(0.1, 1.5), "key_vel")
        elif event == "stop":
            drive.ask("cmd_vel_mux/stop", Trigger())
            if problem := _look_at_rest(drive):
                return Ended(f"after an emergency stop: {problem}; {' '.join(told)}", moving=True)
            drive.ask("cmd_vel_mux/release", Trigger())
        else:
            drive.start(random_.choice(sorted(STARTS)))
        drive.bus.run(random_.uniform(0.05, 2.0))
    troubles.silent = True
    moving = _size(drive.truth.twist) > 1.0
    problem = _look_at_rest(drive)
    return Ended(f"after silence: {problem}; {' '.join(told)}" if problem else "", moving)


def _look_at_rest(drive: FirstDrive) -> str:
    drive.bus.run(REST)
    seen = len(drive.truths)
    drive.bus.run(0.5)
    fastest = max((each.twist for each in drive.truths[seen:]), key=_size, default=Twist(0.0, 0.0))
    moves = abs(fastest.forward) > _SPEED or abs(fastest.turn) > _TURN
    return f"{fastest.forward:.3f} m/s and {fastest.turn:.3f} rad/s {REST:g} s later" if moves else ""


def _size(twist: Twist) -> float:
    return abs(twist.forward) / _SPEED + abs(twist.turn) / _TURN
