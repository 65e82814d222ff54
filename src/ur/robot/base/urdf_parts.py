"""Links and joints, as lines of URDF."""

from collections.abc import Iterable, Iterator


def mount(frame: str, pose: tuple[float, ...], axle: float) -> Iterator[str]:
    """A fixed joint for a frame at a pose in `base_footprint`; `axle` is the height of `base_link` above it."""
    x, y, z, roll, pitch, yaw = pose
    yield from joint(frame, (x, y, z - axle), angles=(roll, pitch, yaw))


def link(name: str, parts: Iterable[str]) -> Iterator[str]:
    """A link with its visuals and inertias."""
    yield f'  <link name="{name}">'
    yield from parts
    yield "  </link>"


def visual(
    shape: str, material: str, at: tuple[float, ...] = (0.0, 0.0, 0.0), angles: tuple[float, ...] = (0.0, 0.0, 0.0)
) -> Iterator[str]:
    """A shape in one of the materials body, tyre, sensor and board."""
    place = f' xyz="{xyz(at)}"' if any(at) else ""
    turn = f' rpy="{xyz(angles)}"' if any(angles) else ""
    origin = f"<origin{place}{turn}/>" if place or turn else ""
    yield f'    <visual>{origin}<geometry>{shape}</geometry><material name="{material}"/></visual>'


def inertial(mass: float, size: tuple[float, float, float], at: tuple[float, float, float]) -> Iterator[str]:
    """Yield the inertia of a solid box, m (b^2 + c^2) / 12 about each axis."""
    x, y, z = (mass * (sum(s * s for s in size) - own * own) / 12.0 for own in size)
    yield f'    <inertial><origin xyz="{xyz(at)}"/><mass value="{write_number(mass)}"/>'
    turning = f'ixx="{write_number(x)}" ixy="0" ixz="0" iyy="{write_number(y)}" iyz="0" izz="{write_number(z)}"'
    yield f"      <inertia {turning}/></inertial>"


def joint(
    name: str,
    at: tuple[float, float, float],
    *,
    kind: str = "fixed",
    parent: str = "base_link",
    child: str = "",
    angles: tuple[float, ...] = (0.0, 0.0, 0.0),
    axis: str = "",
) -> Iterator[str]:
    """The joint `<name>_joint` of a link with the same name, unless `child` is given."""
    turn = f' rpy="{xyz(angles)}"' if any(angles) else ""
    axle = f'<axis xyz="{axis}"/>' if axis else ""
    yield f'  <joint name="{name}_joint" type="{kind}">'
    yield f'    <parent link="{parent}"/><child link="{child or name}"/><origin xyz="{xyz(at)}"{turn}/>{axle}'
    yield "  </joint>"


def xyz(at: tuple[float, ...]) -> str:
    """Numbers separated by spaces, as URDF writes vectors."""
    return " ".join(write_number(value) for value in at)


def write_number(value: float) -> str:
    """Format a number without unnecessary digits."""
    return f"{round(value, 6) + 0.0:.10g}"
