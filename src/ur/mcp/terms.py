"""The terms of a grant: for how long, where and how fast an assistant may drive. Places are in the map, m.

The server keeps them with a grant, and the robot's end keeps the robot within them. Pure.
"""

import math
from typing import Annotated

from msgspec import Meta

from ur.source.foreign.json_values import PrintableValue

_Coordinate = Annotated[float, Meta(ge=-1e5, le=1e5, description="a number of metres from -100000 to 100000")]
MOST_RECTANGLES = 20

_EDGE = 0.05  # m: kept from each border, for the error of the pose
_STOPS_IN = 0.4  # s: to be at rest, and for the age of the pose


class Area(PrintableValue, frozen=True):
    """A rectangle with sides along the axes of the map."""

    left: _Coordinate
    bottom: _Coordinate
    right: _Coordinate
    top: _Coordinate
    name: Annotated[str, Meta(max_length=40)] = ""

    def contains(self, x: float, y: float, margin: float) -> bool:
        """Return whether a place is inside, `margin` m or more from the border (outside of it where negative)."""
        return self.left + margin <= x <= self.right - margin and self.bottom + margin <= y <= self.top - margin


def make_area(x0: float, y0: float, x1: float, y1: float, name: str = "") -> Area:
    """Return the area between two opposite corners."""
    return Area(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1), name)


Areas = Annotated[tuple[Area, ...], Meta(max_length=MOST_RECTANGLES)]
Speed = Annotated[float, Meta(ge=0.01, le=2.0)]
GrantText = Annotated[str, Meta(max_length=64)]


class DriveGrant(PrintableValue, frozen=True):
    """`seconds` from its arrival on, at most `speed` m/s, in one of `within` (everywhere without any), not in `avoid`.

    `text` describes it on the screens of others.
    """

    seconds: Annotated[float, Meta(ge=0.0, le=86400.0)]
    speed: Speed
    within: Areas = ()
    avoid: Areas = ()
    text: GrantText = "assistant"

    def allows(self, x: float, y: float, ahead: float = 0.0, left: float = 0.0) -> bool:
        """Return whether the robot may be at a place at a velocity (m/s): it is at rest before it leaves the area."""
        margin = _EDGE + _STOPS_IN * math.hypot(ahead, left)
        inside = not self.within or any(each.contains(x, y, margin) for each in self.within)
        return inside and not any(each.contains(x, y, -margin) for each in self.avoid)
