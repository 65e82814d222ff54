"""Documented things: a repository, its packages, programs and launch files. Paths are relative to the repository."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

TreeKind = Literal["file", "node", "missing", "elsewhere", "unknown", "cycle", "off"]


TargetState = Literal["found", "missing", "elsewhere", "candidate"]


@dataclass(frozen=True, slots=True)
class BaseCase:
    """A base in one variant; both are empty for files that depend on no base."""

    base: str = ""
    variant: str = ""

    @property
    def label(self) -> str:
        """Return the display text: `magni (lidar)`."""
        return f"{self.base} ({self.variant})" if self.variant else self.base


@dataclass(frozen=True, slots=True)
class Value:
    """A text that applies in some cases; in all if `cases` is empty."""

    text: str
    cases: tuple[BaseCase, ...] = ()


@dataclass(frozen=True, slots=True)
class ArgumentDoc:
    """An `<arg>` of a launch file. `default` is as written: of `default=` or, for a convenience argument, `value=`."""

    name: str
    kind: Literal["required", "optional", "convenience"]
    default: str
    type: str
    doc: str
    condition: str


@dataclass(frozen=True, slots=True)
class ParamDoc:
    """A parameter. `name` starts with `~` if it belongs to the node that contains it."""

    name: str
    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class ParamFileDoc:
    """A YAML file whose parameters are loaded: the file in each case, and the parameters' names."""

    files: tuple[Value, ...]
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TopicDoc:
    """A topic, service or action that a node uses. `source` is the evidence for it; `rate` is in Hz."""

    kind: str  # publishes, subscribes, offers service, ..., or uses
    name: str
    source: Literal["ready", "comment", "table", "base", "remap"]
    detail: str = ""


@dataclass(frozen=True, slots=True)
class NodeDoc:
    """A `<node>` or `<test>` of a launch file. `conditions` are written ones; `only_with`: options that enable it."""

    names: tuple[Value, ...]
    package: tuple[Value, ...]
    type: tuple[Value, ...]
    machine: str
    conditions: tuple[str, ...]
    only_with: str
    cases: tuple[BaseCase, ...]  # in which it starts by default
    traits: tuple[str, ...]
    params: tuple[ParamDoc, ...]
    param_files: tuple[ParamFileDoc, ...]
    remaps: tuple[tuple[str, str], ...]
    topics: tuple[TopicDoc, ...]


@dataclass(frozen=True, slots=True)
class TargetDoc:
    """A file that an include refers to. `path` is empty for one outside of the repository."""

    name: str
    path: str
    state: TargetState
    cases: tuple[BaseCase, ...] = ()


@dataclass(frozen=True, slots=True)
class IncludeDoc:
    """An `<include>` of a launch file: its text, and the files it refers to."""

    written: str
    targets: tuple[TargetDoc, ...]
    conditions: tuple[str, ...]
    only_with: str
    passes: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class TreeItem:
    """A launch file or a node in the tree of what is started. Equal trees are one object."""

    kind: TreeKind
    name: str
    path: str = ""
    detail: str = ""
    note: str = ""
    children: tuple[TreeItem, ...] = ()


@dataclass(frozen=True, slots=True)
class TreeDoc:
    """The nodes that a launch file starts in some cases (if empty: in all)."""

    cases: tuple[BaseCase, ...]
    root: TreeItem


@dataclass(frozen=True, slots=True)
class SupportDoc:
    """Return whether a launch file works for a base; if not, what is missing."""

    case: BaseCase
    missing: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class LaunchDoc:
    """A launch file."""

    path: str
    package: str
    folder: str  # its launch directory
    summary: str
    overview: str
    needs: tuple[str, ...]
    arguments: tuple[ArgumentDoc, ...]
    nodes: tuple[NodeDoc, ...]
    params: tuple[ParamDoc, ...]
    param_files: tuple[ParamFileDoc, ...]
    includes: tuple[IncludeDoc, ...]
    included_by: tuple[str, ...]
    started_by: tuple[str, ...]  # paths of programs
    trees: tuple[TreeDoc, ...]
    support: tuple[SupportDoc, ...]
    problems: tuple[str, ...]
    launcher: str = "roslaunch"

    @property
    def name(self) -> str:
        """Return the last part of the path."""
        return self.path.rpartition("/")[2]


@dataclass(frozen=True, slots=True)
class ProgramDoc:
    """A program in `bin`."""

    path: str
    name: str
    command: str
    summary: str
    overview: str
    starts: tuple[str, ...]  # paths of launch files
    trees: tuple[TreeDoc, ...]


@dataclass(frozen=True, slots=True)
class DirectoryDoc:
    """A launch directory: its purpose, and the launch files in it."""

    path: str
    kind: Literal["node", "task", "view", "other"]
    summary: str
    files: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class BaseDoc:
    """A base. `sensors` are those of the plain base; `variants` with theirs."""

    name: str
    summary: str
    sensors: tuple[str, ...]
    variants: tuple[tuple[str, tuple[str, ...]], ...]


@dataclass(frozen=True, slots=True)
class PackageDoc:
    """A package, or a folder that is not a package. `path` is empty for the repository itself."""

    name: str
    path: str
    description: str
    is_package: bool
    bases: tuple[BaseDoc, ...]
    programs: tuple[ProgramDoc, ...]
    directories: tuple[DirectoryDoc, ...]
    launch_files: tuple[LaunchDoc, ...]


@dataclass(frozen=True, slots=True)
class Documents:
    """A launch repository. `title` is its name; `root` its folder, absolute."""

    title: str
    root: str
    packages: tuple[PackageDoc, ...]
