"""A robot description as data. Lengths are in m, masses in kg, angles in rad, rates in Hz."""

from dataclasses import dataclass
from typing import Literal

from ur.robot.description.pose import Pose, Vector


@dataclass(frozen=True, slots=True)
class Shape:
    """A solid in its link. `size` is that of a box (x, y, z), a cylinder (radius, length) or a sphere (radius).

    A mesh has the `points` of its hull instead.
    """

    kind: Literal["box", "cylinder", "sphere", "mesh"]
    size: tuple[float, ...]
    pose: Pose
    points: tuple[Vector, ...] = ()


@dataclass(frozen=True, slots=True)
class Mesh:
    """A geometry whose size is in a file; `collides` distinguishes collision geometries from visual ones."""

    file: str
    scale: Vector
    pose: Pose
    collides: bool


@dataclass(frozen=True, slots=True)
class Inertia:
    """The inertial part of a link: principal moments about the axes of `pose`, kg m^2."""

    mass: float
    moments: Vector
    pose: Pose


@dataclass(frozen=True, slots=True)
class Link:
    """A link. `meshes` are the geometries whose size is not known."""

    name: str
    collision: tuple[Shape, ...] = ()
    visual: tuple[Shape, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    inertia: Inertia | None = None


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint; `axis` is in its own frame, `velocity` (rad/s) is its velocity limit, None without one."""

    name: str
    kind: str
    parent: str
    child: str
    pose: Pose
    axis: Vector
    velocity: float | None = None


@dataclass(frozen=True, slots=True)
class GazeboSensor:
    """A `<sensor>` of a `<gazebo reference=...>`: its link, its type and plugin, and parameters by name.

    The names are: rate, samples, angle_min, angle_max, range_min, range_max, noise, field_of_view, width, height.
    """

    link: str
    kind: str
    name: str
    plugin: str
    pose: Pose
    figures: tuple[tuple[str, float], ...] = ()

    def figure(self, name: str) -> float | None:
        """Return one of its parameters; None if it is not given."""
        return dict(self.figures).get(name)


@dataclass(frozen=True, slots=True)
class DrivePlugin:
    """A Gazebo plugin that drives wheels: the joints of each side, and its parameters."""

    left: tuple[str, ...]
    right: tuple[str, ...]
    separation: float | None = None
    radius: float | None = None
    velocity: float | None = None
    angular_velocity: float | None = None
    acceleration: float | None = None


@dataclass(frozen=True, slots=True)
class Description:
    """A robot: a tree of links with the root link `root`; `sideways` means that a plugin moves it in all directions."""

    name: str
    root: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    sensors: tuple[GazeboSensor, ...] = ()
    drive: DrivePlugin | None = None
    sideways: bool = False

    def children(self) -> dict[str, list[str]]:
        """Return the child links of each link that has any, in the order of the joints."""
        children: dict[str, list[str]] = {}
        for joint in self.joints:
            children.setdefault(joint.parent, []).append(joint.child)
        return children

    def poses(self) -> dict[str, Pose]:
        """Return the pose of each link in the root link, with every joint at zero."""
        by_parent: dict[str, list[Joint]] = {}
        for joint in self.joints:
            by_parent.setdefault(joint.parent, []).append(joint)
        places, left = {self.root: Pose()}, [self.root]
        while left:
            parent = left.pop()
            for joint in by_parent.get(parent, ()):
                places[joint.child] = places[parent].then(joint.pose)
                left.append(joint.child)
        return places
