"""The layers over the map, and the camera, which a page requests by name.

Layers that no page shows are not computed. `SHOWN` is their only table: `tools/make_wire_numbers.py` makes
`static/wire_numbers.js` and `static/layers.css` of it.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

from ur.web.wire.reading import BadRequestError


class Layer(IntEnum):
    """The subject of points, a grid or a tile."""

    NONE = 0
    MAP = 1
    SCAN = 2
    PLAN = 3
    GLOBAL = 4
    LOCAL = 5
    PARTICLES = 6
    SONARS = 7
    COVARIANCE = 8
    FIDUCIALS = 9
    ROBOTS = 10
    PLOTS = 11
    FRONTIERS = 12
    CAMERA = 16


@dataclass(frozen=True, slots=True)
class MapLayer:
    """A layer that a page can switch on: its label, and its colours on a light and on a dark page."""

    layer: Layer
    label: str
    light: str
    dark: str
    at_first: bool = False
    """True: shown before a user has chosen."""

    @property
    def name(self) -> str:
        """The name of the layer in requests, addresses and style sheets."""
        return self.layer.name.lower()


SHOWN = (
    MapLayer(Layer.SCAN, "Lidar", "#d6336c", "#ff7eb0", at_first=True),
    MapLayer(Layer.PLAN, "Planned path", "#0b6bcb", "#6cb6ff", at_first=True),
    MapLayer(Layer.LOCAL, "Obstacles near the robot", "#d9480f", "#ff8c42"),
    MapLayer(Layer.GLOBAL, "Obstacles on the map", "#e8a50a", "#f2c14e"),
    MapLayer(Layer.PARTICLES, "Possible positions (particles)", "#0a9396", "#35d0ba"),
    MapLayer(Layer.COVARIANCE, "Uncertainty of the position", "#0b7285", "#66d9e8"),
    MapLayer(Layer.SONARS, "Sonars", "#5c940d", "#a9e34b"),
    MapLayer(Layer.FIDUCIALS, "Fiducials", "#5c3d00", "#f2c14e"),
    MapLayer(Layer.ROBOTS, "Other robots", "#8a2be2", "#d2a8ff"),
    MapLayer(Layer.FRONTIERS, "Frontiers (grey: given up)", "#0969da", "#79c0ff", at_first=True),
)
"""In the order of the page's list. The robot's end makes each of them in `ur_nodes.web.layers`."""

LAYERS: Mapping[str, Layer] = {each.name: each.layer for each in SHOWN}
DEFAULT = frozenset(each.layer for each in SHOWN if each.at_first)
_ALWAYS = frozenset({Layer.NONE, Layer.MAP})
_LONGEST = 200
_TOPIC = re.compile(r"/[A-Za-z0-9_/]{1,200}", re.ASCII)


def read_layers(text: str | None) -> frozenset[Layer]:
    """Decode a list of layer names separated by commas; `DEFAULT` for None. Raises BadRequestError."""
    if text is None:
        return DEFAULT | _ALWAYS
    names = text[:_LONGEST].split(",") if text else []
    if len(text) > _LONGEST or not all(name in LAYERS for name in names):
        raise BadRequestError(f"layers: expected some of {','.join(LAYERS)}")
    return _ALWAYS | {LAYERS[name] for name in names}


def is_camera_topic(text: str) -> bool:
    """Return whether a text is a valid full name of a camera's topic."""
    return _TOPIC.fullmatch(text) is not None
