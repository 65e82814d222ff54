"""Sensors of a description: those that Gazebo simulates, and links with typical names of sensors."""

import math
import re
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from ur.robot.description.pose import Pose, make_pose
from ur.robot.description.urdf_parts import Description, GazeboSensor

Kind = Literal["lidar", "camera", "imu", "sonar"]

_OPTICAL = re.compile(r"optical", re.IGNORECASE)
_SONAR = re.compile(r"sonar|ultra_?so(und|nic)|(^|_)us_?\d|hc_?sr04", re.IGNORECASE)
# Rays (ultrasonic and infrared rangers of some centimetres, to the floor or a wall)
_DOWNWARDS = re.compile(r"cliff|wall|drop|bumper", re.IGNORECASE)
_NAMES: Mapping[Kind, re.Pattern[str]] = {
    "sonar": _SONAR,
    "lidar": re.compile(r"lidar|laser|hokuyo|velodyne|(^|_)(lds|lms|sick|scan|scanner|utm|urg)(_|\d|$)", re.IGNORECASE),
    "camera": re.compile(r"camera|raspicam|realsense|kinect|astra|(^|_)zed|webcam|(^|_)cam(_|\d|$)", re.IGNORECASE),
    "imu": re.compile(r"(^|_)imu|gyro", re.IGNORECASE),
}
_DEPTH = re.compile(r"depth|rgbd|realsense|kinect|openni|astra|xtion|oak_d|(^|_)zed(_|\d|$)", re.IGNORECASE)
_DEPTH_VIEW, _DEPTH_REACH, _DEPTH_COLUMNS = 1.0, (0.45, 8.0), 160  # rad, m: usual; a scan needs no more columns
_FEWEST = 32  # rays of a lidar; a sensor with fewer measures a single range
_BODY_FRAMES = ("base_footprint", "base_link", "left_wheel", "right_wheel")


@dataclass(frozen=True, slots=True)
class FoundSensor:
    """A sensor: its frame, its pose in the root link (it looks along x), and its Gazebo parameters if it has some.

    `source` is where it was found. `depth`: it is a depth camera, or a lidar that stands for one.
    """

    kind: Kind
    link: str
    frame: str
    pose: Pose
    source: str
    gazebo: GazeboSensor | None = None
    depth: bool = False

    def figure(self, name: str, ordinary: float, least: float = -1e6, most: float = 1e6) -> float:
        """Return a Gazebo parameter; `ordinary` if it is missing or out of range."""
        value = self.gazebo.figure(name) if self.gazebo else None
        return value if value is not None and least <= value <= most else ordinary


def find_sensors(description: Description) -> tuple[FoundSensor, ...]:
    """Find the sensors that a base file can describe: one lidar, one camera, one IMU, and any number of sonars.

    Of several lidars or cameras, it is the first that Gazebo simulates, else the first link by name. Without a lidar,
    a depth camera stands for one: for the scan that `depthimage_to_laserscan` makes of its pictures.
    """
    taken = set(_BODY_FRAMES)
    found: list[FoundSensor] = []
    single: set[Kind] = set()
    candidates = [*_simulated(description), *_named(description)]
    sonars = {each.link for each in candidates if each.kind == "sonar" and each.gazebo}
    for each in candidates:
        if each.kind == "sonar":
            if each.link in {other.link for other in found} or (sonars and not each.gazebo):
                continue
        elif each.kind in single:
            continue
        single.add(each.kind)
        frame = _free_frame(each.frame, taken)
        taken |= {frame, f"{frame}_body"} if each.kind == "camera" else {frame}
        depth = each.kind == "camera" and _sees_depth(each)
        found.append(FoundSensor(each.kind, each.link, frame, each.pose, each.source, each.gazebo, depth))
    if "lidar" not in single:
        found += [_scan_of(each, _free_frame(f"{each.link}_depth", taken)) for each in found if each.depth]
    return tuple(found)


def _sees_depth(camera: FoundSensor) -> bool:
    gazebo = camera.gazebo
    return _DEPTH.search(f"{gazebo.kind} {gazebo.plugin}" if gazebo else camera.link) is not None


def _scan_of(camera: FoundSensor, frame: str) -> FoundSensor:
    """Return the lidar that stands for a depth camera: level, as far as it sees to the sides."""
    half = camera.figure("field_of_view", _DEPTH_VIEW, 0.1, 2.6) / 2.0
    figures = {"angle_min": -half, "angle_max": half, "samples": _DEPTH_COLUMNS, "rate": camera.figure("rate", 10.0)}
    figures |= dict(zip(("range_min", "range_max"), _DEPTH_REACH, strict=True))
    gazebo = GazeboSensor(camera.link, "depth", camera.frame, "", camera.pose, tuple(figures.items()))
    level = make_pose(camera.pose.at, (0.0, 0.0, camera.pose.angles()[2]))
    source = f"depth camera {camera.frame}, by depthimage_to_laserscan"
    return replace(camera, kind="lidar", frame=frame, pose=level, source=source, gazebo=gazebo)


def list_extra_sensors(description: Description, used: tuple[FoundSensor, ...]) -> tuple[str, ...]:
    """Return the links of simulated sensors that do not fit into a base file."""
    mine = {sensor.link for sensor in used}
    return tuple(dict.fromkeys(each.link for each in description.sensors if each.link not in mine))


def _simulated(description: Description) -> Iterator[FoundSensor]:
    places = description.poses()
    for sensor in description.sensors:
        kind = _kind(sensor)
        if kind is not None:
            pose = places[sensor.link].then(sensor.pose)
            frame = (_optical_child(description.children(), sensor.link) if kind == "camera" else None) or sensor.link
            yield FoundSensor(kind, sensor.link, frame, pose, f"gazebo sensor on {sensor.link}", sensor)


def _kind(sensor: GazeboSensor) -> Kind | None:
    kind, name = sensor.kind.lower(), f"{sensor.name} {sensor.link}"
    if kind in ("sonar", "ultrasonic"):
        return "sonar"
    if kind in ("ray", "gpu_ray", "lidar", "gpu_lidar"):
        reach = sensor.figure("range_max")
        if _DOWNWARDS.search(name) or (reach is not None and reach < 0.5):
            return None
        samples = sensor.figure("samples")
        few = samples is not None and samples < _FEWEST
        return "sonar" if few or "_range" in sensor.plugin or _SONAR.search(name) else "lidar"
    if kind in ("camera", "depth", "depth_camera", "multicamera", "wideanglecamera", "rgbd", "rgbd_camera"):
        return "camera"
    return "imu" if kind == "imu" else None


def _named(description: Description) -> Iterator[FoundSensor]:
    places = description.poses()
    children = description.children()
    movable = {joint.child for joint in description.joints if joint.kind != "fixed"}
    for kind, pattern in _NAMES.items():
        matching = [link.name for link in description.links if pattern.search(link.name) and link.name not in movable]
        plain = [name for name in matching if not _OPTICAL.search(name)]
        for name in plain or matching:
            pose = places[name]
            frame = name
            if kind == "camera":
                if _OPTICAL.search(name):  # z forward and x right (REP 103): rotated back to x forward
                    pose = pose.then(make_pose((0.0, 0.0, 0.0), (0.0, -math.pi / 2.0, math.pi / 2.0)))
                frame = _optical_child(children, name) or name
            elif kind == "sonar" and _has_ancestor(description, name, set(matching)):
                continue
            yield FoundSensor(kind, name, frame, pose, f"link {name}, by its name")


def _optical_child(children: Mapping[str, Sequence[str]], link: str) -> str | None:
    """Return the first optical frame below a link."""
    left = deque([link])
    while left:
        for child in children.get(left.popleft(), ()):
            if _OPTICAL.search(child):
                return child
            left.append(child)
    return None


def _has_ancestor(description: Description, link: str, names: set[str]) -> bool:
    by_child = {joint.child: joint.parent for joint in description.joints}
    while link in by_child:
        link = by_child[link]
        if link in names:
            return True
    return False


def _free_frame(name: str, taken: set[str]) -> str:
    frame = re.sub(r"\W", "_", name, flags=re.ASCII)
    if not re.match(r"[A-Za-z]", frame) or re.fullmatch(r"caster_\d+", frame):
        frame = f"sensor_{frame}"
    while frame in taken or f"{frame}_body" in taken:
        frame += "_frame"
    return frame
