"""A base as URDF: the frames and shapes that RViz and robot_state_publisher show.

`base_footprint` lies on the ground (REP 105 uses it as the base's planar frame), `base_link` above it at axle height.
"""

from __future__ import annotations

from collections.abc import Iterator

from ur.robot.base import Base, Camera, Lidar

_COLOURS = {"body": "0.16 0.45 0.70 1", "tyre": "0.12 0.12 0.13 1", "sensor": "0.95 0.60 0.10 1"}


def write_urdf(base: Base) -> str:
    """The URDF text of a base in one variant. Wheel joints are `left_wheel_joint` and `right_wheel_joint`."""
    variant = f", variant {base.variant}" if base.variant else ""
    lines = [
        '<?xml version="1.0"?>',
        f"<!-- Made from bases/{base.name}/base.yaml{variant} by tools/make_urdf.py: change that file instead. -->",
        f'<robot name="{base.name}">',
        *(f'  <material name="{name}"><color rgba="{rgba}"/></material>' for name, rgba in _COLOURS.items()),
        '  <link name="base_footprint"/>',
        *_chassis(base),
        *_wheel(base, "left", 1.0),
        *_wheel(base, "right", -1.0),
    ]
    for number, caster in enumerate(base.casters, start=1):
        height = caster.radius - base.wheels.radius
        lines += _link(f"caster_{number}", f'<sphere radius="{_n(caster.radius)}"/>', "tyre")
        lines += _joint(f"caster_{number}", (caster.x, caster.y, height))
    if base.lidar:
        lines += _lidar(base, base.lidar)
    if base.raspicam:
        lines += _camera(base, base.raspicam)
    lines.append("</robot>")
    return "\n".join(lines) + "\n"


def _chassis(base: Base) -> Iterator[str]:
    xs, ys = zip(*base.footprint, strict=True)
    length, width = max(xs) - min(xs), max(ys) - min(ys)
    inner = min(width, base.wheels.separation - base.wheels.width - 0.01)
    height = base.height - base.ground_clearance
    middle = (max(xs) + min(xs)) / 2.0, (max(ys) + min(ys)) / 2.0
    bottom = base.ground_clearance - base.wheels.radius
    deck = max(0.02, height - 2.0 * base.wheels.radius + base.ground_clearance)
    yield from _joint("base", (0.0, 0.0, base.wheels.radius), parent="base_footprint", child="base_link")
    yield '  <link name="base_link">'
    yield from _visual(f"{_n(length)} {_n(inner)} {_n(height - deck)}", (*middle, bottom + (height - deck) / 2.0))
    yield from _visual(f"{_n(length)} {_n(width)} {_n(deck)}", (*middle, bottom + height - deck / 2.0))
    yield from _inertial(base.mass, (length, width, height), (*middle, bottom + height / 2.0))
    yield "  </link>"


def _visual(size: str, at: tuple[float, float, float]) -> Iterator[str]:
    for tag, material in (("visual", '<material name="body"/>'), ("collision", "")):
        yield f'    <{tag}><origin xyz="{_xyz(at)}"/><geometry><box size="{size}"/></geometry>{material}</{tag}>'


def _wheel(base: Base, side: str, sign: float) -> Iterator[str]:
    wheels = base.wheels
    shape = f'<cylinder radius="{_n(wheels.radius)}" length="{_n(wheels.width)}"/>'
    size = (2.0 * wheels.radius, wheels.width, 2.0 * wheels.radius)
    yield from _link(f"{side}_wheel", shape, "tyre", rpy="1.570796 0 0", mass=wheels.mass, size=size)
    place = (0.0, sign * wheels.separation / 2.0, 0.0)
    yield from _joint(f"{side}_wheel", place, kind="continuous", axis="0 1 0")


def _lidar(base: Base, lidar: Lidar) -> Iterator[str]:
    x, y, z, *angles = lidar.pose
    yield from _link(lidar.frame, '<cylinder radius="0.035" length="0.04"/>', "sensor")
    yield from _joint(lidar.frame, (x, y, z - base.wheels.radius), rpy=" ".join(_n(angle) for angle in angles))


def _camera(base: Base, camera: Camera) -> Iterator[str]:
    """A body that looks along x, and in it the optical frame (REP 103)."""
    x, y, z, *angles = camera.pose
    body = f"{camera.frame}_body"
    yield from _link(body, '<box size="0.01 0.025 0.024"/>', "sensor")
    yield from _joint(body, (x, y, z - base.wheels.radius), rpy=" ".join(_n(angle) for angle in angles))
    yield f'  <link name="{camera.frame}"/>'
    yield from _joint(camera.frame, (0.0, 0.0, 0.0), parent=body, rpy="-1.570796 0 -1.570796")


def _link(
    name: str, shape: str, material: str, rpy: str = "0 0 0", mass: float = 0.0, size: tuple[float, ...] = ()
) -> Iterator[str]:
    yield f'  <link name="{name}">'
    place = f'<origin rpy="{rpy}"/>' if rpy != "0 0 0" else ""
    yield f'    <visual>{place}<geometry>{shape}</geometry><material name="{material}"/></visual>'
    if mass:
        yield from _inertial(mass, (size[0], size[1], size[2]), (0.0, 0.0, 0.0))
    yield "  </link>"


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
    rpy: str = "0 0 0",
    axis: str = "",
) -> Iterator[str]:
    turn = f' rpy="{rpy}"' if rpy != "0 0 0" else ""
    axle = f'<axis xyz="{axis}"/>' if axis else ""
    yield f'  <joint name="{name}_joint" type="{kind}">'
    yield f'    <parent link="{parent}"/><child link="{child or name}"/><origin xyz="{_xyz(at)}"{turn}/>{axle}'
    yield "  </joint>"


def _xyz(at: tuple[float, ...]) -> str:
    return " ".join(_n(value) for value in at)


def _n(value: float) -> str:
    return f"{round(value, 6) + 0.0:g}"
