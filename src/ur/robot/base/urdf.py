"""A base as URDF: the frames and shapes that RViz and robot_state_publisher show.

`base_footprint` lies on the ground (REP 105 uses it as the base's planar frame), `base_link` above it at axle height.
"""

from __future__ import annotations

from collections.abc import Iterator

from ur.robot.base import Base, Camera, Cliff, ImuErrors, Lidar, Sonar

_COLOURS = {
    "body": "0.16 0.45 0.70 1",
    "tyre": "0.12 0.12 0.13 1",
    "sensor": "0.95 0.60 0.10 1",
    "board": "0.10 0.35 0.20 1",
}


def write_urdf(base: Base, mesh: str) -> str:
    """The URDF text of a base in one variant. Wheel joints are `left_wheel_joint` and `right_wheel_joint`.

    `mesh` is the URL of the body's mesh (`ur.robot.base.body_mesh`), as `package://PACKAGE/FILE.stl`.
    """
    variant = f", variant {base.variant}" if base.variant else ""
    lines = [
        '<?xml version="1.0"?>',
        f"<!-- Made from bases/{base.name}/base.yaml{variant} by tools/make_urdf.py: change that file instead. -->",
        f'<robot name="{base.name}">',
        *(f'  <material name="{name}"><color rgba="{rgba}"/></material>' for name, rgba in _COLOURS.items()),
        '  <link name="base_footprint"/>',
        *_chassis(base, mesh),
        *_wheel(base, "left", 1.0),
        *_wheel(base, "right", -1.0),
    ]
    for number, caster in enumerate(base.casters, start=1):
        lines += _link(f"caster_{number}", _visual(f'<sphere radius="{_n(caster.radius)}"/>', "tyre"))
        lines += _joint(f"caster_{number}", (caster.x, caster.y, caster.radius - base.wheels.radius))
    if base.lidar:
        lines += _lidar(base, base.lidar)
    if base.raspicam:
        lines += _camera(base, base.raspicam)
    for sonar in base.sonars.at if base.sonars else ():
        lines += _sonar(base, sonar)
    for cliff in base.cliffs.at if base.cliffs else ():
        lines += _cliff(base, cliff)
    if base.imu:
        lines += _imu(base, base.imu)
    lines.append("</robot>")
    return "\n".join(lines) + "\n"


def _chassis(base: Base, mesh: str) -> Iterator[str]:
    xs, ys = zip(*base.footprint, strict=True)
    length, width, height = max(xs) - min(xs), max(ys) - min(ys), base.height - base.ground_clearance
    middle = (max(xs) + min(xs)) / 2.0, (max(ys) + min(ys)) / 2.0
    mass = max(0.1 * base.mass, base.mass - 2.0 * base.wheels.mass)
    shape = f'<mesh filename="{mesh}"/>'
    down = (0.0, 0.0, -base.wheels.radius)  # the mesh stands on the ground
    yield from _joint("base", (0.0, 0.0, base.wheels.radius), parent="base_footprint", child="base_link")
    yield '  <link name="base_link">'
    yield from _visual(shape, "body", down)
    yield f'    <collision><origin xyz="{_xyz(down)}"/><geometry>{shape}</geometry></collision>'
    yield from _inertial(mass, (length, width, height), (*middle, base.ground_clearance + height / 2.0 + down[2]))
    yield "  </link>"


def _wheel(base: Base, side: str, sign: float) -> Iterator[str]:
    wheels = base.wheels
    shape = f'<cylinder radius="{_n(wheels.radius)}" length="{_n(wheels.width)}"/>'
    size = (2.0 * wheels.radius, wheels.width, 2.0 * wheels.radius)
    turned = (1.570796, 0.0, 0.0)
    parts = [*_visual(shape, "tyre", angles=turned), *_inertial(wheels.mass, size, (0.0, 0.0, 0.0))]
    yield from _link(f"{side}_wheel", parts)
    place = (0.0, sign * wheels.separation / 2.0, 0.0)
    yield from _joint(f"{side}_wheel", place, kind="continuous", axis="0 1 0")


def _lidar(base: Base, lidar: Lidar) -> Iterator[str]:
    yield from _link(lidar.frame, _visual('<cylinder radius="0.035" length="0.04"/>', "sensor"))
    yield from _mount(base, lidar.frame, lidar.pose)


def _camera(base: Base, camera: Camera) -> Iterator[str]:
    """A body that looks along x, and in it the optical frame (REP 103)."""
    body = f"{camera.frame}_body"
    lens = '<cylinder radius="0.004" length="0.006"/>'
    parts = [
        *_visual('<box size="0.004 0.025 0.024"/>', "board", (-0.002, 0.0, 0.0)),
        *_visual(lens, "sensor", (0.003, 0.0, 0.0), (0.0, 1.570796, 0.0)),
    ]
    yield from _link(body, parts)
    yield from _mount(base, body, camera.pose)
    yield f'  <link name="{camera.frame}"/>'
    yield from _joint(camera.frame, (0.0, 0.0, 0.0), parent=body, angles=(-1.570796, 0.0, -1.570796))


def _sonar(base: Base, sonar: Sonar) -> Iterator[str]:
    """An HC-SR04: a board with a sender and a receiver; they end where the ranges begin."""
    parts = [*_visual('<box size="0.002 0.045 0.020"/>', "board", (-0.013, 0.0, 0.0))]
    for side in (0.013, -0.013):
        parts += _visual(
            '<cylinder radius="0.008" length="0.012"/>', "sensor", (-0.006, side, 0.0), (0.0, 1.570796, 0.0)
        )
    yield from _link(sonar.frame, parts)
    yield from _mount(base, sonar.frame, sonar.pose)


def _cliff(base: Base, cliff: Cliff) -> Iterator[str]:
    """A small window that looks down."""
    yield from _link(cliff.frame, _visual('<box size="0.004 0.012 0.008"/>', "sensor", (-0.002, 0.0, 0.0)))
    yield from _mount(base, cliff.frame, (*cliff.position, 0.0, 1.570796, 0.0))


def _imu(base: Base, imu: ImuErrors) -> Iterator[str]:
    yield from _link(imu.frame, _visual('<box size="0.020 0.016 0.003"/>', "board"))
    yield from _mount(base, imu.frame, imu.pose)


def _mount(base: Base, frame: str, pose: tuple[float, ...]) -> Iterator[str]:
    x, y, z, roll, pitch, yaw = pose
    yield from _joint(frame, (x, y, z - base.wheels.radius), angles=(roll, pitch, yaw))


def _link(name: str, parts: Iterator[str] | list[str]) -> Iterator[str]:
    yield f'  <link name="{name}">'
    yield from parts
    yield "  </link>"


def _visual(
    shape: str, material: str, at: tuple[float, ...] = (0.0, 0.0, 0.0), angles: tuple[float, ...] = (0.0, 0.0, 0.0)
) -> Iterator[str]:
    place = f' xyz="{_xyz(at)}"' if any(at) else ""
    turn = f' rpy="{_xyz(angles)}"' if any(angles) else ""
    origin = f"<origin{place}{turn}/>" if place or turn else ""
    yield f'    <visual>{origin}<geometry>{shape}</geometry><material name="{material}"/></visual>'


def _inertial(mass: float, size: tuple[float, float, float], at: tuple[float, float, float]) -> Iterator[str]:
    # That of a solid box, m (b^2 + c^2) / 12 about each axis.
    x, y, z = (mass * (sum(s * s for s in size) - own * own) / 12.0 for own in size)
    yield f'    <inertial><origin xyz="{_xyz(at)}"/><mass value="{_n(mass)}"/>'
    yield f'      <inertia ixx="{_n(x)}" ixy="0" ixz="0" iyy="{_n(y)}" iyz="0" izz="{_n(z)}"/></inertial>'


def _joint(
    name: str,
    at: tuple[float, float, float],
    *,
    kind: str = "fixed",
    parent: str = "base_link",
    child: str = "",
    angles: tuple[float, ...] = (0.0, 0.0, 0.0),
    axis: str = "",
) -> Iterator[str]:
    turn = f' rpy="{_xyz(angles)}"' if any(angles) else ""
    axle = f'<axis xyz="{axis}"/>' if axis else ""
    yield f'  <joint name="{name}_joint" type="{kind}">'
    yield f'    <parent link="{parent}"/><child link="{child or name}"/><origin xyz="{_xyz(at)}"{turn}/>{axle}'
    yield "  </joint>"


def _xyz(at: tuple[float, ...]) -> str:
    return " ".join(_n(value) for value in at)


def _n(value: float) -> str:
    return f"{round(value, 6) + 0.0:.10g}"
