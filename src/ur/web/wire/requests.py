"""Requests of pages, as JSON. Data from a browser is untrusted until decoded here.

A request that causes motion has `n`, the newest challenge of the mux that the page has received.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from msgspec import Meta

from ur.source.foreign.json_values import Stamp, read_json
from ur.web.wire.frames import Layer
from ur.web.wire.layers import read_layers
from ur.web.wire.map_requests import MapRequest, PackedMapRequest, PackedWalls, PackedZone
from ur.web.wire.reading import BadRequestError, Coordinate, Heading, Name, PageRequest

MOST_PLOTS = 8
"""Plots of one page."""

PLOT = re.compile(r"/[A-Za-z0-9_/]{1,100}:[A-Za-z0-9_]{1,40}(\.[A-Za-z0-9_]{1,40}){0,6}", re.ASCII)
"""A topic's full name and the path of a field."""


def read_plots(text: str | None) -> frozenset[str] | None:
    """Decode a list of plots separated by commas; None without a list. Raises BadRequestError."""
    if text is None:
        return None
    plots = text.split(",") if text else []
    if len(plots) > MOST_PLOTS or not all(PLOT.fullmatch(plot) for plot in plots):
        raise BadRequestError(f"plots: expected at most {MOST_PLOTS} of the form /TOPIC:FIELD, separated by commas")
    return frozenset(plots)


def split_plot(plot: str) -> tuple[str, str]:
    """Split a plot into its topic and the path of its field."""
    topic, _, path = plot.partition(":")
    return topic, path


"""Characters of a message: eight plots with the longest names fit in."""

_Texts = Annotated[
    dict[Literal["layers", "plots"], str], Meta(min_length=1, description="an object with layers and plots, texts")
]


@dataclass(frozen=True, slots=True)
class ViewRequest:
    """The layers that a page shows, with `Layer.PLOTS` while its plots are open, and the plots."""

    layers: frozenset[Layer]
    plots: frozenset[str] = frozenset()


def read_view(values: Mapping[str, str]) -> ViewRequest:
    """Decode the `layers` and `plots` of a query. Raises BadRequestError."""
    layers, plots = read_layers(values.get("layers")), read_plots(values.get("plots"))
    return ViewRequest(layers) if plots is None else ViewRequest(layers | {Layer.PLOTS}, plots)


def read_view_message(data: object) -> ViewRequest:
    """Decode a message: a JSON object with the same texts as the query. Raises BadRequestError."""
    return read_view(read_json(data if isinstance(data, str) else None, _Texts, LONGEST))


PatrolAction = Literal["start", "pause", "resume", "end"]
LeaseAction = Literal["acquire", "take", "ask", "grant", "release"]

LONGEST = 4096
"""Characters of the longest request."""

MOST_STOPS = 50
"""Places of a patrol."""

LEAST_LIMIT = 10
"""Percent: the lowest speed limit of a page."""

_Hold = Annotated[int, Meta(ge=1, lt=2**32, description="a whole number from 1 to 2^32 - 1")]
_Velocity = Annotated[float, Meta(ge=-100.0, le=100.0)]
# Not tuple[Coordinate, Coordinate]: msgspec 0.22 crashes on a union of a text with limits and such a tuple.
_Point = Annotated[tuple[Coordinate, ...], Meta(min_length=2, max_length=2)]
_STOPS = f"1 to {MOST_STOPS} names or [x, y]"


class _Stamped(PageRequest, frozen=True, tag="", rename={"answers": "n"}):
    """A request that causes motion."""

    answers: Stamp


class Alive(_Stamped, frozen=True, tag="alive"):
    """A heartbeat: the page is connected, and has received the challenge `answers`."""


class Stick(_Stamped, frozen=True, tag="stick"):
    """A velocity (m/s, rad/s) while the user holds the stick; each press increments `hold`."""

    hold: _Hold
    forward: _Velocity
    turn: _Velocity
    left: _Velocity = 0.0


class LetGo(PageRequest, frozen=True, tag="let_go"):
    """Release of the stick, by the user or detected by the page."""

    hold: _Hold


class GoalRequest(_Stamped, frozen=True, tag="goal"):
    """Drive to a position in the map frame, with any final heading if `yaw` is None."""

    x: Coordinate
    y: Coordinate
    yaw: Heading | None = None


class GoTo(_Stamped, frozen=True, tag="go_to"):
    """Drive to a place by its name."""

    place: Name


class InitialPose(_Stamped, frozen=True, tag="pose"):
    """Set the robot's pose in the map frame."""

    x: Coordinate
    y: Coordinate
    yaw: Heading


class Cancel(PageRequest, frozen=True, tag="cancel"):
    """Cancel the goal of any client."""


class AskForLease(_Stamped, frozen=True, tag="lease", rename={"action": "do", "answers": "n"}):
    """A request about the lease."""

    action: LeaseAction


class StopAll(PageRequest, frozen=True, tag="stop"):
    """Trigger the emergency stop, which stops all commands."""


class ReleaseAll(PageRequest, frozen=True, tag="release"):
    """End the emergency stop."""


class AskPatrol(_Stamped, frozen=True, tag="patrol", rename={"action": "do", "answers": "n", "stops": "places"}):
    """Start a patrol, or pause, resume or end the active one.

    `stops` are names of places, or x, y in m in the map frame with any final heading. The robot waits `wait` s at each.
    """

    action: PatrolAction
    stops: Annotated[tuple[Name | _Point, ...], Meta(max_length=MOST_STOPS, description=_STOPS)] = ()
    loop: bool = False
    wait: Annotated[float, Meta(ge=0.0, le=3600.0, description="seconds from 0 to 3600")] = 1.0

    def __post_init__(self) -> None:
        if self.action == "start" and not self.stops:
            raise ValueError(f"places: expected {_STOPS}")


class LimitSpeed(PageRequest, frozen=True, tag="limit"):
    """Limit all motion to this percentage of the base's highest speeds."""

    percent: Annotated[int, Meta(ge=LEAST_LIMIT, le=100)]


class SwitchObstacleStop(PageRequest, frozen=True, tag="obstacles"):
    """Switch the mux's obstacle stop for manual commands on or off."""

    on: bool


class SaveRecording(PageRequest, frozen=True, tag="save_recording"):
    """Have the black box of the robot write what has happened."""


_DriveRequest = (
    Alive
    | Stick
    | LetGo
    | GoalRequest
    | GoTo
    | InitialPose
    | Cancel
    | AskForLease
    | StopAll
    | ReleaseAll
    | AskPatrol
    | LimitSpeed
    | SwitchObstacleStop
    | SaveRecording
)
Request = _DriveRequest | MapRequest


def read_request(text: object) -> Request:
    """Decode a request. Raises BadRequestError."""
    found: _DriveRequest | PackedMapRequest = read_json(text, _DriveRequest | PackedMapRequest, LONGEST)
    return found.unpack() if isinstance(found, PackedZone | PackedWalls) else found
