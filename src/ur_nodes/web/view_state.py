"""The robot as JSON for pages: its state, and the facts that do not change while it runs."""

import math

from ur.robot.base import Base, load_base
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur.source.project import launch_library
from ur_nodes.client.mux import MuxView
from ur_nodes.client.patrol_text import PatrolStatus, describe_patrol
from ur_nodes.client.snapshot import GoalReport, describe_recoveries
from ur_nodes.exploration.status import ExploreStatus, describe_status
from ur_nodes.motion.lease.text import Lease
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Battery

_RADIUS = 0.2  # m, of a robot whose outline is not known
_FORWARD, _TURN = 0.5, 1.0  # m/s and rad/s of a base that is not known: the mux has the limits of the base


class RobotFacts:
    """Reads the base and its variant once. Unknown bases get a round outline."""

    def __init__(self, node: Node) -> None:
        name, variant = node.facts.get("base_name", ""), node.facts.get("variant", "")
        self._base = _load(name, variant) if isinstance(name, str) and isinstance(variant, str) and name else None
        self._name = printable(str(name))[:40]

    @property
    def limits(self) -> tuple[float, float, float]:
        """The highest velocities: m/s, rad/s, and m/s to either side."""
        limits = self._base.limits if self._base else None
        if limits is None:
            return _FORWARD, _TURN, 0.0
        return limits.velocity, limits.angular_velocity, limits.lateral_velocity

    def describe(self) -> dict[str, object]:
        """The facts for the page: base, outline (corners in m, in the frame of the base), limits and stop."""
        outline = [list(each) for each in self._base.footprint] if self._base else _circle(_RADIUS)
        stop = self._base.limits.describe_stop() if self._base else ""
        return {"base": self._name, "outline": outline, "limits": list(self.limits), "stop": stop}


def _load(name: str, variant: str) -> Base | None:
    try:
        return load_base(launch_library(), name, variant)
    except UserError:
        return None


def _circle(radius: float) -> list[list[float]]:
    angles = [math.tau * part / 16 for part in range(16)]
    return [[radius * math.cos(each), radius * math.sin(each)] for each in angles]


_LONGEST_LINE = 500  # characters


def list_sources(topics: object) -> list[str]:
    """Return the names of a mux's sources from its parameter `topics`, highest priority first; none if malformed."""
    if not isinstance(topics, list) or not all(isinstance(each, dict) for each in topics):
        return []
    known = [(each.get("priority"), each.get("name")) for each in topics[:20]]
    good = [(urgency, name) for urgency, name in known if isinstance(urgency, int) and isinstance(name, str)]
    return [printable(name)[:40] for _, name in sorted(good, key=lambda each: -each[0])]


def describe_goal(goal: GoalReport, left: float | None) -> dict[str, object]:
    """Describe the last goal; `left` is the distance to it in m."""
    place: list[float | None] | None = None if goal.pose is None else [round(each, 3) for each in goal.pose]
    if place is not None and goal.any_heading:
        place[2] = None
    rest = None if left is None or goal.over else round(left, 1)
    text = goal.text
    if not text and (recoveries := describe_recoveries(goal)):
        text = recoveries if rest is None else f"{recoveries}, {rest} m left"
    return {"number": goal.number, "place": place, "state": goal.state.name.lower(), "text": text, "left": rest}


def describe_lease(lease: Lease | None) -> dict[str, object] | None:
    """Describe the lease; None before the mux has sent one."""
    if lease is None:
        return None
    return {
        "state": lease.state,
        "client": lease.client,
        "name": lease.name,
        "program": lease.program,
        "since": lease.since,
        "until": lease.until,
        "note": lease.note,
        "asking": [{"client": each.client, "name": each.name} for each in lease.asking],
        "takenFrom": lease.taken_from.client if lease.taken_from else None,
    }


def describe_patrol_state(status: PatrolStatus | None) -> dict[str, object] | None:
    """Describe the patrol of the robot; None without a patrol node. `line` is empty before the first patrol."""
    if status is None:
        return None
    return {
        "state": status.state,
        "line": describe_patrol(status),
        "stops": [[each.name, each.x, each.y] for each in status.route.stops],
        "index": status.index,
        "loop": status.route.loop,
    }


def describe_exploration(status: ExploreStatus | None) -> dict[str, object] | None:
    """Describe the exploration: its state, and the line that a terminal shows; None without an exploration."""
    if status is None:
        return None
    return {"state": status.state, "line": printable(describe_status(status))[:_LONGEST_LINE]}


def describe_mux(view: MuxView) -> dict[str, object]:
    """Describe the mux: emergency stop, source, the last request, and obstacles."""
    return {
        "stopped": view.stopped,
        "active": printable(view.active)[:40],
        "asked": view.asked,
        "problem": printable(view.problem)[:300],
        "obstacles": {"state": view.obstacles.state, "text": view.obstacles.text},
    }


def describe_battery(battery: Battery) -> dict[str, object]:
    """Describe the battery: `share` of its charge from 0 to 1, and `volts`; None where unknown."""
    return {
        "share": round(battery.fraction, 2) if 0.0 <= battery.fraction <= 1.0 else None,
        "volts": round(battery.voltage, 1) if math.isfinite(battery.voltage) else None,
        "charging": battery.charging,
    }
