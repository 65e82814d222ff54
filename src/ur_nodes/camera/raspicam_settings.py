"""The parameters of raspicam_node."""

from __future__ import annotations

import re

from ur_nodes.camera.source import Adjustments, CameraSettings
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters

NAME = "raspicam_node"


def read_settings(own: Parameters) -> CameraSettings:
    """Read the parameters that all kinds of cameras have. Raises UserError."""
    limits = {"brightness": 0, "contrast": -100, "saturation": -100, "sharpness": -100, "shutter_speed": 0}
    given: dict[str, int] = {}
    for name, least in limits.items():
        if own.has(name):
            most = 10_000_000 if name == "shutter_speed" else 100
            given[name] = round(own.number(name, minimum=least, maximum=most))
    return CameraSettings(
        width=own.integer("width", 640, minimum=16),
        height=own.integer("height", 480, minimum=16),
        rate=own.number("framerate", 30.0, minimum=0.1, maximum=1000.0),
        quality=round(own.number("quality", 80, minimum=1, maximum=100)),
        flip_horizontally=own.boolean("hFlip", False),
        flip_vertically=own.boolean("vFlip", False),
        adjustments=Adjustments(**given),
    )


def read_name(node: Node) -> str:
    """Read the name of the camera and its calibration file, by default that of the node. Raises UserError."""
    own, full = node.parameters, node.name.strip("/").replace("/", "_")
    name = own.text("camera_name", "") or ("camera" if full == NAME else full)
    if not re.fullmatch(r"[\w-][\w.-]{0,99}", name):
        own.fail("camera_name", name, "letters, digits, _, - and dots")
    return name
