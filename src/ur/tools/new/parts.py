"""Requests for new files, and the resulting files."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class NewFile:
    """A file to write; `path` is relative to the package."""

    path: str
    text: str | bytes
    executable: bool = False


@dataclass(frozen=True, slots=True)
class NewArgument:
    """An `<arg>`: required if it has neither a default nor a value."""

    name: str
    doc: str
    default: str | None = None
    value: str | None = None


@dataclass(frozen=True, slots=True)
class NodeTopic:
    """A topic of a node: its name as the node writes it, its message type if known, and whether the node publishes."""

    name: str
    message: str = ""
    published: bool = False


@dataclass(frozen=True, slots=True)
class Observed:
    """The observed interface of a node: `services` without those of every node, `parameters` by name below the node.

    A parameter that the node requested and that is not set is None.
    """

    topics: tuple[NodeTopic, ...] = ()
    services: tuple[str, ...] = ()
    parameters: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class NodeRequest:
    """A launch directory `n_<name>` for one node."""

    name: str
    package: str
    type: str
    summary: str
    observed: Observed = field(default_factory=Observed)


@dataclass(frozen=True, slots=True)
class IncludedPart:
    """A launch file that another one includes: its `$(find)` path, and its arguments by name.

    `arguments` are their defaults, None for required ones; `docs` their comments.
    """

    file: str
    arguments: Mapping[str, str | None]
    docs: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class BaseRequest:
    """A new base: lengths in m, mass in kg, speeds in m/s and rad/s."""

    name: str
    summary: str
    length: float
    width: float
    height: float
    mass: float
    wheel_radius: float
    wheel_separation: float
    velocity: float
    angular_velocity: float
    lateral_velocity: float = 0.0
    lidar: bool = False
    raspicam: bool = False
