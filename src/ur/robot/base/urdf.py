"""A base as URDF: the frames and shapes that RViz and robot_state_publisher show.

`base_footprint` lies on the ground (REP 105 uses it as the base's planar frame), `base_link` above it at axle height.
"""

from collections.abc import Iterator

from ur.robot.base import Base
from ur.robot.base.urdf_parts import inertial, joint, link, visual, write_number, xyz

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
        lines += link(f"caster_{number}", visual(f'<sphere radius="{write_number(caster.radius)}"/>', "tyre"))
        lines += joint(f"caster_{number}", (caster.x, caster.y, caster.radius - base.wheels.radius))
    for _, sensor in base.list_sensors():
        lines += sensor.urdf(base.wheels.radius)
    lines.append("</robot>")
    return "\n".join(lines) + "\n"


def _chassis(base: Base, mesh: str) -> Iterator[str]:
    xs, ys = zip(*base.footprint, strict=True)
    length, width, height = max(xs) - min(xs), max(ys) - min(ys), base.height - base.ground_clearance
    middle = (max(xs) + min(xs)) / 2.0, (max(ys) + min(ys)) / 2.0
    mass = max(0.1 * base.mass, base.mass - 2.0 * base.wheels.mass)
    shape = f'<mesh filename="{mesh}"/>'
    down = (0.0, 0.0, -base.wheels.radius)  # the mesh's origin is on the ground
    yield from joint("base", (0.0, 0.0, base.wheels.radius), parent="base_footprint", child="base_link")
    yield '  <link name="base_link">'
    yield from visual(shape, "body", down)
    yield f'    <collision><origin xyz="{xyz(down)}"/><geometry>{shape}</geometry></collision>'
    yield from inertial(mass, (length, width, height), (*middle, base.ground_clearance + height / 2.0 + down[2]))
    yield "  </link>"


def _wheel(base: Base, side: str, sign: float) -> Iterator[str]:
    wheels = base.wheels
    shape = f'<cylinder radius="{write_number(wheels.radius)}" length="{write_number(wheels.width)}"/>'
    size = (2.0 * wheels.radius, wheels.width, 2.0 * wheels.radius)
    turned = (1.570796, 0.0, 0.0)
    parts = [*visual(shape, "tyre", angles=turned), *inertial(wheels.mass, size, (0.0, 0.0, 0.0))]
    yield from link(f"{side}_wheel", parts)
    place = (0.0, sign * wheels.separation / 2.0, 0.0)
    yield from joint(f"{side}_wheel", place, kind="continuous", axis="0 1 0")
