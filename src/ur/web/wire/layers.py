"""The layers over the map, and the camera, that a page asks for by name. What no page shows is not computed."""

from __future__ import annotations

import re
from collections.abc import Mapping

from ur.web.wire.frames import Layer
from ur.web.wire.reading import BadRequestError

LAYERS: Mapping[str, Layer] = {
    "scan": Layer.SCAN,
    "plan": Layer.PLAN,
    "local": Layer.LOCAL,
    "global": Layer.GLOBAL,
    "particles": Layer.PARTICLES,
    "covariance": Layer.COVARIANCE,
    "sonars": Layer.SONARS,
    "fiducials": Layer.FIDUCIALS,
    "robots": Layer.ROBOTS,
    "frontiers": Layer.FRONTIERS,
}
"""By the name in `static/link_state.js`."""

DEFAULT = frozenset({Layer.SCAN, Layer.PLAN, Layer.FRONTIERS})
_ALWAYS = frozenset({Layer.NONE, Layer.MAP})
_LONGEST = 200
_TOPIC = re.compile(r"/[A-Za-z0-9_/]{1,200}", re.ASCII)


def read_layers(text: str | None) -> frozenset[Layer]:
    """The layers that a list of names, separated by commas, asks for; `DEFAULT` for None. Raises BadRequestError."""
    if text is None:
        return DEFAULT | _ALWAYS
    names = text[:_LONGEST].split(",") if text else []
    if len(text) > _LONGEST or not all(name in LAYERS for name in names):
        raise BadRequestError(f"layers: expected some of {','.join(LAYERS)}")
    return _ALWAYS | {LAYERS[name] for name in names}


def is_camera_topic(text: str) -> bool:
    """Return whether a text may be the full name of a camera's topic."""
    return _TOPIC.fullmatch(text) is not None
