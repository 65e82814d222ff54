"""Rules, their examples, and the views of files that rules inspect."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

from ur.check.survey import LaunchSurvey
from ur.check.worlds import CachedWorld
from ur.source.diagnostic import Diagnostic, Note, Severity
from ur.source.printable import printable

_CHECKED_SUFFIXES = (".launch", ".xml", ".py", ".test", ".yaml", ".yml")
_NAMED = 3  # links that a note names


class EscapingLinks:
    """Finds links that lead outside of their package, and outside of the requested file or folder.

    A workspace may contain links to packages: those count as separate packages.
    """

    def __init__(self, asked_for: str) -> None:
        self._asked_for = os.path.realpath(asked_for)
        self.left_out: list[str] = []

    def leave_out(self, path: str, *, in_package: bool) -> bool:
        """Return whether a path is a link that leads outside; record it in `left_out` if it would have been checked."""
        if not os.path.islink(path):  # noqa: PTH114 - for each file, and pathlib takes longer
            return False
        target = os.path.realpath(path)
        inside = target == self._asked_for or target.startswith(f"{self._asked_for.rstrip('/')}/")
        if inside or (not in_package and os.path.isfile(f"{target}/package.xml")):  # noqa: PTH113 - likewise
            return False
        if path.endswith(_CHECKED_SUFFIXES) or os.path.isdir(target):  # noqa: PTH112 - likewise
            self.left_out.append(path)
        return True


def describe_left_out(left_out: Sequence[str]) -> str | None:
    """Return one line about omitted links and one about unreadable folders; None if there is neither."""
    links = [path for path in left_out if os.path.islink(path)]  # noqa: PTH114 - these are texts
    folders = [path for path in left_out if path not in links]
    lines = []
    if links:
        lead = "1 link leads out of" if len(links) == 1 else f"{len(links)} links lead out of"
        lines.append(_describe(links, f"{lead} what is checked"))
    if folders:
        lines.append(_describe(folders, f"{len(folders)} folder{'' if len(folders) == 1 else 's'} cannot be read"))
    return "\n".join(lines) or None


def _describe(paths: Sequence[str], subject: str) -> str:
    names = ", ".join(os.path.relpath(path) for path in paths[:_NAMED])
    more = f" and {len(paths) - _NAMED} more" if len(paths) > _NAMED else ""
    return printable(f"note: {subject} and {'is' if len(paths) == 1 else 'are'} left out: {names}{more}")


if TYPE_CHECKING:
    from ur.launchfile.plan.specs import NodeSpec, ParamSpec, Plan
    from ur.launchfile.syntax import Element, LaunchFile
    from ur.launchfile.world import World
    from ur.source.file import SourceFile, Span


class RuleGroup(Enum):
    """The subject of a rule; `--select` and `--ignore` take these codes too."""

    XML = "xml"
    ARGUMENTS = "arguments"
    FILES = "files"
    NAMES = "names"
    VALUES = "values"
    MACHINES = "machines"
    YAML = "yaml"
    CONVENTIONS = "conventions"
    COMMENTS = "comments"
    LAUNCH_API = "launch-api"


class RuleFinding(NamedTuple):
    """A finding of a rule; the engine adds the rule's id and severity. `subject` is that of Diagnostic."""

    span: Span
    message: str
    help: str | None = None
    notes: tuple[Note, ...] = ()
    subject: str = ""


class TextEdit(NamedTuple):
    """A safe change of a text: the characters of a span become `text`."""

    span: Span
    text: str


class Example(NamedTuple):
    """A package in memory. In a bad one, `«` and `»` mark the position of the finding.

    `files` maps paths in the package to texts; names with a leading `/` are used as they are. The package is called
    `my_robot` unless `files` holds a `package.xml` with another name. Paths in `executables` may be executed.
    """

    files: Mapping[str, str]
    executables: tuple[str, ...] = ()
    environment: Mapping[str, str] = {}


class BaseNames(NamedTuple):
    """A base that a package describes, and its variants beside the plain one."""

    name: str
    variants: tuple[str, ...]


class Package(NamedTuple):
    """The package that checked files belong to. `follows_conventions`: see docs/how-to/check.md."""

    name: str
    folder: str
    follows_conventions: bool
    bases: tuple[BaseNames, ...]
    depends: frozenset[str]


class LaunchView(NamedTuple):
    """A launch file and the properties that its rules need."""

    path: str
    package: Package | None
    world: World
    survey: LaunchSurvey

    @property
    def tree(self) -> LaunchFile:
        """The syntax tree."""
        return self.survey.tree

    @property
    def declared(self) -> Mapping[str, tuple[Element, ...]]:
        """Return the `<arg>` tags outside of `<include>`, by name."""
        return self.survey.declared

    @property
    def used(self) -> Mapping[str, tuple[Span, ...]]:
        """Return the positions at which `$(arg)` or `$(eval)` refer to an argument, by its name."""
        return self.survey.used


def survey_launch_file(path: str, package: Package | None, world: World) -> LaunchView:
    """Return a launch file as rules see it. Raises OSError."""
    return LaunchView(path, package, world, LaunchSurvey(path, world.read_bytes(path), world.read_bytes))


class YamlView(NamedTuple):
    """A YAML file."""

    source: SourceFile
    package: Package | None
    world: CachedWorld


class ProgramView(NamedTuple):
    """A program in a package's `bin` folder."""

    source: SourceFile
    package: Package
    world: CachedWorld
    launch_files: Mapping[str, LaunchView]  # every launch file of the package by its path


class PackageView(NamedTuple):
    """A whole package."""

    package: Package
    launch_files: tuple[LaunchView, ...]
    programs: tuple[ProgramView, ...]
    included: Mapping[str, tuple[Span, ...]]  # path of a launch file to the <include> tags that name it


class LaunchedNode(NamedTuple):
    """A node of a resolved launch file. `local`: it runs on this computer, so that its program can be checked."""

    node: NodeSpec
    element: Element
    local: bool
    package: Package | None
    world: CachedWorld


class PlanView(NamedTuple):
    """A resolved launch file with its options as they are by default. `element_at`: the tag at a path and offset."""

    plan: Plan
    element_at: Callable[[str, int], Element | None]


class ParamView(NamedTuple):
    """A parameter of a resolved launch file whose value a command prints."""

    param: ParamSpec
    element: Element
    package: Package | None
    world: World


class Rule(NamedTuple):
    """One kind of problem. A rule without a hook is reported by the parser or resolver of launch files.

    The meaning of an `id` never changes. Those of `RuleGroup.CONVENTIONS` apply only to packages that follow them.
    """

    id: str
    group: RuleGroup
    severity: Severity
    summary: str
    explanation: str
    bad: tuple[Example, ...]
    good: tuple[Example, ...]
    element: Callable[[Element, LaunchView], Iterable[RuleFinding]] | None = None
    launch_file: Callable[[LaunchView], Iterable[RuleFinding]] | None = None
    yaml_file: Callable[[YamlView], Iterable[RuleFinding]] | None = None
    program: Callable[[ProgramView], Iterable[RuleFinding]] | None = None
    whole_package: Callable[[PackageView], Iterable[RuleFinding]] | None = None
    node: Callable[[LaunchedNode], Iterable[RuleFinding]] | None = None
    plan: Callable[[PlanView], Iterable[RuleFinding]] | None = None
    param: Callable[[ParamView], Iterable[RuleFinding]] | None = None
    fix: Callable[[Diagnostic], tuple[TextEdit, ...]] | None = None
    only_parameters: bool = False  # not in YAML files that no launch file loads, where launch files are checked


def launch_example(
    text: str,
    files: Mapping[str, str] | None = None,
    *,
    name: str = "launch/example.launch",
    executables: tuple[str, ...] = (),
) -> Example:
    """Return an example that consists mainly of one launch file."""
    return Example({name: text.strip("\n") + "\n", **(files or {})}, executables)


def launch_examples(*texts: str) -> tuple[Example, ...]:
    """Return an example for each text of a launch file."""
    return tuple(map(launch_example, texts))
