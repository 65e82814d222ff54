"""Parser of URDF. Every function raises UserError, with the link or joint, for an invalid value."""

import math
import re
import shlex
from collections.abc import Iterable, Iterator, Sequence
from typing import NoReturn
from xml.etree.ElementTree import Element

from ur.robot.description.pose import Pose, Vector, make_pose
from ur.robot.description.urdf_parts import Description, DrivePlugin, GazeboSensor, Inertia, Joint, Link, Mesh, Shape
from ur.source.diagnostic import UserError, error
from ur.source.foreign.xml_text import parse_xml

MOST = 1e6


def read_numbers(text: str) -> tuple[float, ...] | None:
    """Parse numbers separated by whitespace; None if one is not a finite number, or greater than MOST."""
    try:
        numbers = tuple(float(word) for word in text.split())
    except ValueError:
        return None
    return numbers if all(math.isfinite(number) and abs(number) <= MOST for number in numbers) else None


def read_number(text: str | None) -> float | None:
    """Parse one number; None for any other text."""
    numbers = read_numbers(text or "")
    return numbers[0] if numbers and len(numbers) == 1 else None


Extension = tuple[str, Element]  # the link that it is about ('' for the whole robot), and its tag

_FIGURES = {
    "rate": ("update_rate",),
    "samples": ("ray/scan/horizontal/samples", "lidar/scan/horizontal/samples"),
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


_KINDS = ("fixed", "continuous", "revolute", "prismatic", "floating", "planar")
_XACRO = re.compile(r"\{[^}]*xacro/?\}")
_ELEMENTS = frozenset({"material", "link", "joint", "transmission", "gazebo", "sensor", "plugin"})
_LONGEST = 5_000_000  # characters; a large robot has some 500,000
_MOST = 2000  # links, joints
_MOST_SHAPES = 20_000


def parse_urdf(text: str, path: str) -> Description:
    """Parse a URDF; `path` names it in errors. XML entities are refused, since a description does not need them."""
    try:
        root = parse_xml(text.lstrip("\ufeff \t\r\n"), length=_LONGEST)
    except ValueError as problem:
        _fail(path, f"cannot be read as a URDF: {problem}")
    if root.tag != "robot":
        _fail(path, f"begins with <{root.tag}>, expected a URDF, which begins with <robot>")
    for name, most in (("link", _MOST), ("joint", _MOST), ("gazebo", 2 * _MOST)):
        if (count := len(root.findall(name))) > most:
            _fail(path, f"{count:,} elements <{name}>, expected at most {most:,}")
    if (count := len(root.findall("link/*/geometry/*"))) > _MOST_SHAPES:
        _fail(path, f"{count:,} shapes and meshes, expected at most {_MOST_SHAPES:,}")
    called = next((str(each.tag) for each in root.iter() if _XACRO.match(str(each.tag))), "")
    if called and not path.endswith(".xacro"):
        message = f"uses xacro (<xacro:{called.rpartition('}')[2]}>), and its name does not end with .xacro"
        _fail(path, message, f"cp {shlex.quote(path)} {shlex.quote(path)}.xacro, and give that file, to expand it")
    links = tuple(_link(path, element) for element in root.findall("link"))
    if not links:
        _fail_without_links(path, root)
    joints = tuple(_joint(path, element) for element in root.findall("joint"))
    plugins = [(each.get("reference", ""), each) for each in root.findall("gazebo")]
    known = {link.name for link in links}
    return Description(
        name=root.get("name", ""),
        root=_find_root(path, links, joints),
        links=links,
        joints=joints,
        sensors=tuple(sensor for sensor in read_sensors(plugins) if sensor.link in known),
        drive=read_drive(plugins),
        sideways=drives_sideways(plugins),
    )


def _fail_without_links(path: str, root: Element) -> NoReturn:
    # xacro of ROS Indigo and before called macros without their prefix; today's xacro leaves such calls unexpanded.
    calls = [each.tag for each in root if isinstance(each.tag, str) and each.tag not in _ELEMENTS]
    if not calls:
        _fail(path, "no link, expected a tree of links with one root")
    help_ = f"write <xacro:{calls[0]}> where it is a macro: xacro no longer takes calls without the prefix"
    _fail(path, f"no link, and <{calls[0]}> is not an element of URDF, expected a tree of links with one root", help_)


def _find_root(path: str, links: Sequence[Link], joints: Sequence[Joint]) -> str:
    names = [link.name for link in links]
    children = [joint.child for joint in joints]
    for what, given in (("link", names), ("child link", children)):
        seen: set[str] = set()
        for name in given:
            if name in seen:
                _fail(path, f"{what} {name!r} is given twice, expected a tree of links")
            seen.add(name)
    known = set(names)
    for joint in joints:
        for name in (joint.parent, joint.child):
            if name not in known:
                _fail(path, f"joint {joint.name!r} names link {name!r}, which does not exist")
    held = set(children)
    roots = [name for name in names if name not in held]
    if len(roots) != 1:
        _fail(
            path,
            f"{len(roots)} links without a parent ({', '.join(roots[:5])}), expected a tree of links with one root",
        )
    whole = Description("", roots[0], tuple(links), tuple(joints))
    if len(whole.poses()) != len(names):
        _fail(path, "joints form a loop, expected a tree of links")
    return roots[0]


def _link(path: str, element: Element) -> Link:
    name = element.get("name", "")
    where = f"link {name!r}"
    if not name:
        _fail(path, "a link has no name, expected <link name=...>")
    return Link(
        name,
        tuple(_shapes(path, where, element.findall("collision"))),
        tuple(_shapes(path, where, element.findall("visual"))),
        tuple(_meshes(path, where, element)),
        _inertia(path, where, element.find("inertial")),
    )


def _shapes(path: str, where: str, elements: Iterable[Element]) -> Iterator[Shape]:
    for element in elements:
        pose = _origin(path, where, element)
        for kind in element.findall("geometry/*"):
            if kind.tag == "box":
                yield Shape("box", _numbers(path, where, kind, "size", 3), pose)
            elif kind.tag == "cylinder":
                radius, length = (_numbers(path, where, kind, key, 1)[0] for key in ("radius", "length"))
                yield Shape("cylinder", (radius, length), pose)
            elif kind.tag == "sphere":
                yield Shape("sphere", _numbers(path, where, kind, "radius", 1), pose)


def _meshes(path: str, where: str, link: Element) -> Iterator[Mesh]:
    for part in (*link.iterfind("collision"), *link.iterfind("visual")):
        for mesh in part.iterfind("geometry/mesh"):
            scale = _vector(path, where, mesh, "scale") if mesh.get("scale") else (1.0, 1.0, 1.0)
            yield Mesh(mesh.get("filename", ""), scale, _origin(path, where, part), part.tag == "collision")


def _inertia(path: str, where: str, element: Element | None) -> Inertia | None:
    if element is None or (mass := element.find("mass")) is None:
        return None
    value = _numbers(path, where, mass, "value", 1)[0]
    if value < 0.0:
        _fail(path, f"{where}: mass {value:g}, expected at least 0")
    tensor = element.find("inertia")
    moments = (
        [_numbers(path, where, tensor, key, 1)[0] if tensor.get(key) else 0.0 for key in ("ixx", "iyy", "izz")]
        if tensor is not None
        else [0.0, 0.0, 0.0]
    )
    return Inertia(value, (moments[0], moments[1], moments[2]), _origin(path, where, element))


def _joint(path: str, element: Element) -> Joint:
    name, kind = element.get("name", ""), element.get("type", "")
    where = f"joint {name!r}"
    if kind not in _KINDS:
        _fail(path, f"{where}: type {kind!r}, expected one of {', '.join(_KINDS)}")
    ends = [end.get("link", "") if (end := element.find(key)) is not None else "" for key in ("parent", "child")]
    axle, limit = element.find("axis"), element.find("limit")
    axis = _vector(path, where, axle, "xyz") if axle is not None and axle.get("xyz") else (1.0, 0.0, 0.0)
    length = math.hypot(*axis)
    velocity = None
    if limit is not None and limit.get("velocity"):
        velocity = _numbers(path, where, limit, "velocity", 1)[0]
    return Joint(
        name,
        "continuous" if kind == "revolute" and _turns_on(limit) else kind,
        ends[0],
        ends[1],
        _origin(path, where, element),
        (axis[0] / length, axis[1] / length, axis[2] / length) if length > 0.0 else (1.0, 0.0, 0.0),
        velocity,
    )


def _turns_on(limit: Element | None) -> bool:
    """Return whether a joint turns twice or more: many wheels are revolute joints with wide limits."""
    ends = [_to_float(limit.get(key)) for key in ("lower", "upper")] if limit is not None else [0.0, 0.0]
    return ends[1] - ends[0] >= 4.0 * math.pi


def _to_float(text: str | None) -> float:
    try:
        return float(text or 0.0)
    except ValueError:
        return 0.0


def _origin(path: str, where: str, element: Element) -> Pose:
    origin = element.find("origin")
    if origin is None:
        return Pose()
    at = _vector(path, where, origin, "xyz") if origin.get("xyz") else (0.0, 0.0, 0.0)
    angles = _vector(path, where, origin, "rpy") if origin.get("rpy") else (0.0, 0.0, 0.0)
    return make_pose(at, angles)


def _vector(path: str, where: str, element: Element, key: str) -> Vector:
    x, y, z = _numbers(path, where, element, key, 3)
    return x, y, z


def _numbers(path: str, where: str, element: Element, key: str, count: int) -> tuple[float, ...]:
    text = element.get(key, "")
    numbers = read_numbers(text)
    if numbers is None or len(numbers) != count:
        what = "a number" if count == 1 else f"{count} numbers"
        _fail(path, f"{where}: {key} of <{element.tag}> is {text[:80]!r}, expected {what} of at most {MOST:g}")
    return numbers


def _fail(path: str, message: str, help_: str | None = None) -> NoReturn:
    raise UserError(error(f"{path}: {message}", rule="bad-description", help=help_, subject=path))
