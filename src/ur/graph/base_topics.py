"""Topics of our nodes that depend on the sensors of the robot's base."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ur.launchfile.plan.model import NodeSpec, ParamValue
from ur.launchfile.query.topics import NameUse, Use, remap_name
from ur.robot.base import Base, load_base
from ur.source.diagnostic import UserError

_PACKAGE = "ubiquity_launches"
_MAX_ROBOTS = 100
_CAMERA = ("image_raw", "image/compressed", "camera_info")


def find_base_uses(node: NodeSpec, params: Mapping[str, ParamValue]) -> tuple[NameUse, ...]:
    """Find what a simulator or driver adapter of ours publishes and subscribes because of its parameters and base.

    Where the base is not known, a lidar's topic is in doubt. Empty for other nodes.
    """
    find = _NODES.get(node.type) if node.package == _PACKAGE else None
    if find is None:
        return ()
    own = {
        name.removeprefix(f"{node.full_name}/"): value
        for name, value in params.items()
        if name.startswith(f"{node.full_name}/")
    }
    return tuple(
        NameUse(name if name.startswith("/") else remap_name(name, node), use, "base", doubt=doubt)
        for name, use, doubt in find(own)
    )


_Found = Iterator[tuple[str, Use, str]]


def _simulated(own: Mapping[str, ParamValue]) -> _Found:
    robots = own.get("robots")
    count = min(robots, _MAX_ROBOTS) if isinstance(robots, int) else 1
    if own.get("publish_clock") is True:
        yield "/clock", "publishes", ""
    for prefix in [f"robot_{number}/" for number in range(count)] if count > 1 else [""]:
        for name in ("odom", "joint_states", "base_pose_ground_truth"):
            yield prefix + name, "publishes", ""
        yield f"~{prefix}collisions", "publishes", ""
        yield f"{prefix}cmd_vel", "subscribes", ""
        for name, doubt in _sensor_topics(own):
            yield prefix + name, "publishes", doubt


def _sensor_topics(own: Mapping[str, ParamValue]) -> Iterator[tuple[str, str]]:
    base = _load(own)
    if base is None:
        yield "scan", "only if the base has a lidar"
        return
    for part in (base.lidar, base.sonars, base.imu, base.battery):
        if part is not None:
            yield part.topic, ""
    if base.bumpers is not None:
        yield from ((f"{base.bumpers.topic}/{bumper.name}", "") for bumper in base.bumpers.at)
    if base.cliffs is not None:
        yield from ((f"{base.cliffs.topic}/{cliff.name}", "") for cliff in base.cliffs.at)
    if base.raspicam is not None:
        yield from ((f"raspicam_node/{name}", "") for name in _CAMERA)


def _adapted(own: Mapping[str, ParamValue]) -> _Found:
    base = _load(own)
    yield "joint_states", "publishes", ""
    yield "odom", "subscribes", ""
    if own.get("publish_tf") is True:
        yield "/tf", "publishes", ""
    if own.get("rename_scan") is True and (base is None or base.lidar is not None):
        doubt = "only if the base has a lidar" if base is None else ""
        yield base.lidar.topic if base and base.lidar else "scan", "publishes", doubt
        yield "driver/scan", "subscribes", doubt
    if own.get("bumper_messages"):
        yield "driver/bumpers", "subscribes", ""
        if base is not None and base.bumpers is not None:
            yield from ((f"{base.bumpers.topic}/{bumper.name}", "publishes", "") for bumper in base.bumpers.at)


def _load(own: Mapping[str, ParamValue]) -> Base | None:
    try:
        return load_base(str(own.get("package", "")), str(own.get("base", "")), str(own.get("variant", "")))
    except (UserError, OSError):
        return None


_NODES = {"simulator": _simulated, "driver_adapter": _adapted}
