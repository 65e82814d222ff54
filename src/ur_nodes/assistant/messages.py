"""Messages of the server of `ur mcp` to the robot's end, one JSON object a line, and the answers."""

from typing import Annotated

from msgspec import Meta

from ur.mcp.grants import DriveGrant
from ur.source.foreign.json_values import ForeignValue

_Number = Annotated[int, Meta(ge=0, lt=2**53)]
Challenge = Annotated[int, Meta(ge=0, lt=2**62)]
_Place = Annotated[float, Meta(ge=-1e5, le=1e5)]
LONGEST_DRIVE = 5.0
"""Seconds of a velocity that one call may ask for."""


class LifeSign(ForeignValue, frozen=True, tag_field="do", tag="beat"):
    """The assistant waits for the end of its call: a sign of life, many times a second.

    `n` is the newest challenge that the server had received before it asked for the sign, 0 for none.
    """

    n: Challenge = 0


class SetGrant(ForeignValue, frozen=True, tag_field="do", tag="grant"):
    """The grant from now on; None: it was taken back, or is over."""

    grant: DriveGrant | None = None


class DriveCall(ForeignValue, frozen=True, tag_field="do", tag="drive"):
    """Drive at a velocity, m/s ahead and to the left, rad/s to the left, for so long."""

    id: _Number
    forward: Annotated[float, Meta(ge=-2.0, le=2.0)]
    turn: Annotated[float, Meta(ge=-4.0, le=4.0)]
    seconds: Annotated[float, Meta(gt=0.0, le=LONGEST_DRIVE)]
    left: Annotated[float, Meta(ge=-2.0, le=2.0)] = 0.0


class GoCall(ForeignValue, frozen=True, tag_field="do", tag="go"):
    """Drive to a place of the map, m; `yaw` in rad, None for any heading; for `seconds` at most."""

    id: _Number
    x: _Place
    y: _Place
    yaw: Annotated[float, Meta(ge=-7.0, le=7.0)] | None = None
    seconds: Annotated[float, Meta(gt=0.0, le=600.0)] = 60.0


class ExploreCall(ForeignValue, frozen=True, tag_field="do", tag="explore"):
    """Drive to places from which the map grows, until it is complete; for `seconds` at most."""

    id: _Number
    seconds: Annotated[float, Meta(gt=0.0, le=600.0)] = 60.0


class StopCall(ForeignValue, frozen=True, tag_field="do", tag="stop"):
    """Stop what the assistant has begun."""


class LookCall(ForeignValue, frozen=True, tag_field="do", tag="look"):
    """Describe the robot; with `picture` its map as a PNG file, too."""

    id: _Number
    picture: bool = False


Message = LifeSign | SetGrant | DriveCall | GoCall | ExploreCall | StopCall | LookCall
