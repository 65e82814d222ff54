"""Facts about the robot that do not change while it runs: its name, outline and limits."""

import math

from ur.robot.base import Base, load_base
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur.source.project import launch_library
from ur_nodes.ports.node import Node

_RADIUS = 0.2  # m, of a robot whose outline is not known
_FORWARD, _TURN = 0.5, 1.0  # m/s and rad/s of a base that is not known: the mux has the limits of the base


class RobotFacts:
    """Reads the base and its variant once. Unknown bases get a round outline."""

    def __init__(self, node: Node) -> None:
        name, variant = node.facts.get("base_name", ""), node.facts.get("variant", "")
        self._base = _load(name, variant) if isinstance(name, str) and isinstance(variant, str) and name else None
        self._name = printable(str(name))[:40]

    @property
    def limits(self) -> tuple[float, float]:
        """The highest velocities, m/s and rad/s."""
        limits = self._base.limits if self._base else None
        return (limits.velocity, limits.angular_velocity) if limits else (_FORWARD, _TURN)

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
