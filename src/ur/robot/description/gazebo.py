"""Extensions for Gazebo in a URDF: sensors, and plugins that drive wheels.

Their tags differ between releases and plugins, so unknown tags are ignored instead of rejected.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from xml.etree.ElementTree import Element

from ur.robot.description.numbers import read_number, read_numbers
from ur.robot.description.pose import Pose, make_pose
from ur.robot.description.urdf_parts import DrivePlugin, GazeboSensor

Extension = tuple[str, Element]  # the link that it is about ('' for the whole robot), and its tag

_FIGURES = {
    "rate": ("update_rate",),
    "samples": (
        "ray/scan/horizontal/samples",
        "lidar/scan/horizontal/samples",
    ),
    "angle_min": ("ray/scan/horizontal/min_angle", "lidar/scan/horizontal/min_angle"),
    "angle_max": ("ray/scan/horizontal/max_angle", "lidar/scan/horizontal/max_angle"),
    "range_min": ("ray/range/min", "lidar/range/min"),
    "range_max": ("ray/range/max", "lidar/range/max"),
    "noise": ("ray/noise/stddev", "lidar/noise/stddev"),
    "field_of_view": ("camera/horizontal_fov",),
    "width": ("camera/image/width",),
    "height": ("camera/image/height",),
}
_DRIVES = re.compile(r"diff_?drive|skid_?steer", re.IGNORECASE)
_SIDEWAYS = re.compile(r"planar_?move|force_?based_?move|mecanum|omni_?d(rive|irection)|holonomic", re.IGNORECASE)
_SEPARATION = ("wheelSeparation", "wheel_separation")
_RADIUS = ("wheel_radius", "wheelRadius")
_DIAMETER = ("wheelDiameter", "wheel_diameter")
_VELOCITY = ("max_linear_velocity", "max_velocity")
_ACCELERATION = ("wheelAcceleration", "max_wheel_acceleration", "max_linear_acceleration")


def read_sensors(extensions: Iterable[Extension]) -> Iterator[GazeboSensor]:
    """Yield the sensors on links, in the order of the file."""
    for link, element in extensions:
        for sensor in element.findall("sensor") if link else ():
            plugin = sensor.find("plugin")
            figures = [
                (name, value) for name, paths in _FIGURES.items() if (value := _number(sensor, paths)) is not None
            ]
            yield GazeboSensor(
                link,
                sensor.get("type", ""),
                sensor.get("name", ""),
                plugin.get("filename", "") if plugin is not None else "",
                _pose(sensor.findtext("pose")),
                tuple(figures),
            )


def read_drive(extensions: Iterable[Extension]) -> DrivePlugin | None:
    """Return the first plugin that drives wheels on two sides."""
    for _, element in extensions:
        for plugin in element.iter("plugin"):
            if _DRIVES.search(f"{plugin.get('filename', '')} {plugin.get('name', '')}"):
                return _drive(plugin)
    return None


def drives_sideways(extensions: Iterable[Extension]) -> bool:
    """Return whether a plugin moves the robot in all directions."""
    plugins = [plugin for _, element in extensions for plugin in element.iter("plugin")]
    return any(_SIDEWAYS.search(f"{plugin.get('filename', '')} {plugin.get('name', '')}") for plugin in plugins)


def _drive(plugin: Element) -> DrivePlugin:
    sides: dict[str, list[str]] = {"left": [], "right": []}
    for element in plugin:
        found = re.fullmatch(
            r"(?:front|rear|middle)?_?(left|right)_?(?:front|rear|middle)?_?joint", element.tag.lower()
        )
        if found:
            sides[found[1]] += (element.text or "").split()
    diameter = _number(plugin, _DIAMETER)
    return DrivePlugin(
        tuple(sides["left"]),
        tuple(sides["right"]),
        separation=_positive(_number(plugin, _SEPARATION)),
        radius=_positive(_number(plugin, _RADIUS)) or _positive(diameter and diameter / 2.0),
        velocity=_positive(_number(plugin, _VELOCITY)),
        angular_velocity=_positive(_number(plugin, ("max_angular_velocity",))),
        acceleration=_positive(_number(plugin, _ACCELERATION)),
    )


def _number(element: Element, paths: Sequence[str]) -> float | None:
    return next((value for path in paths if (value := read_number(element.findtext(path))) is not None), None)


def _positive(value: float | None) -> float | None:
    return value if value is not None and value > 0.0 else None


def _pose(text: str | None) -> Pose:
    numbers = read_numbers(text or "")
    if numbers is None or len(numbers) != 6:
        return Pose()
    x, y, z, roll, pitch, yaw = numbers
    return make_pose((x, y, z), (roll, pitch, yaw))
