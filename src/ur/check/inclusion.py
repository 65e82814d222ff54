"""Includes between launch files, by the possible paths of `<include>` tags."""

import re
from collections.abc import Iterable, Iterator, Mapping
from posixpath import commonpath
from typing import NamedTuple

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.launchfile.syntax import Element
from ur.source.file import SourceFile, Span
from ur.source.foreign.json_values import Count, ForeignValue

_PIECE = re.compile(r"\$\([^)]{0,500}\)")
_ANYWHERE = "$(any folder)/"
_NAMED_FILE = re.compile(r"""["'/]([\w.-]{1,200}(?:[._]launch\.(?:py|xml|ya?ml)))["']""")
_IN_PACKAGE = re.compile(r"\$\(find\s+(\S+)\s*\)/")


class Inclusions(NamedTuple):
    """By path of a launch file: `<include>` tags of other files that may refer to it, and the arguments they pass."""

    tags: Mapping[str, tuple[Span, ...]] = {}
    passed: Mapping[str, frozenset[str]] = {}


class IncludeTag(ForeignValue, frozen=True, array_like=True):
    """An `<include>` tag: its `file` as written, the position of that, and the arguments that it passes."""

    file: str
    start: Count
    end: Count
    passes: tuple[str, ...]


class PossibleInclude(NamedTuple):
    """An `<include>` tag, the other files that it may refer to, and the names of the arguments that it passes."""

    span: Span
    files: tuple[str, ...]
    passes: frozenset[str]


class IncludeFinder:
    """Finds the files, among those of `views`, that `<include>` tags may refer to."""

    def __init__(self, views: Iterable[LaunchView]) -> None:
        self._by_name: dict[str, list[str]] = {}
        self._paths: dict[str, None] = {}
        self._folders: dict[str, dict[str, None]] = {}  # by package
        for view in views:
            self._paths[view.path] = None
            self._by_name.setdefault(view.path.rpartition("/")[2], []).append(view.path)
            if view.package is not None:
                self._folders.setdefault(view.package.name, {})[view.package.folder] = None

    def find(self, source: SourceFile, tags: Iterable[IncludeTag]) -> tuple[PossibleInclude, ...]:
        """Return the tags of a file that may refer to others, each with those files."""
        found = []
        for tag in tags:
            files = self._meant_in(source.path, tag.file)
            if files:
                found.append(PossibleInclude(Span(source, tag.start, tag.end), files, frozenset(tag.passes)))
        return tuple(found)

    def files_of(self, include: Element, view: LaunchView) -> tuple[str, ...]:
        """Return the files that a tag of a file may refer to, without that file."""
        return self._meant_in(view.path, include.attributes.get("file", ""))

    def _meant_in(self, path: str, file: str) -> tuple[str, ...]:
        found = [meant for meant in self._meant_by(file) if meant != path]
        if len(found) > 1 and file.startswith(_ANYWHERE):
            shared = {meant: len(commonpath((meant, path))) for meant in found}
            found = [meant for meant in found if shared[meant] == max(shared.values())]
        return tuple(found)

    def _meant_by(self, file: str) -> Iterable[str]:
        parts = _PIECE.split(file)
        if not any(parts):
            return ()  # a path that is only an argument may mean every file, and tells nothing
        package = _IN_PACKAGE.match(file)
        if package and len(parts) == 2 and package.group(1) in self._folders:
            meant = (f"{folder}{parts[1]}" for folder in self._folders[package.group(1)])
            return [path for path in meant if path in self._paths]
        pattern = re.compile(".*".join(map(re.escape, parts)) + r"\Z")
        _, slash, name = parts[-1].rpartition("/")
        candidates = self._by_name.get(name, []) if slash else self._paths
        return [path for path in candidates if path.endswith(parts[-1]) and pattern.search(path)]


def list_includes(view: LaunchView) -> Iterator[Element]:
    """Yield the `<include>` tags of a launch file."""
    return (element for element, _ in walk_elements(view.tree.launch) if element.name == "include")


def list_include_tags(view: LaunchView) -> Iterator[IncludeTag]:
    """Yield the `<include>` tags of a launch file, without its tree."""
    for element in list_includes(view):
        span = element.value_span("file")
        passes = tuple(sorted({*_passed_by(element, view)}))
        yield IncludeTag(element.attributes.get("file", ""), span.start, span.end, passes)


def list_named_files(source: SourceFile) -> Iterator[IncludeTag]:
    """Yield the launch files that a text in another language names: any of them may be included."""
    for match in _NAMED_FILE.finditer(source.text):
        yield IncludeTag(_ANYWHERE + match.group(1), match.start(1), match.end(1), ())


def passes_all(include: Element) -> bool:
    """Return whether a tag passes all arguments of its file."""
    return include.attributes.get("pass_all_args", "false").lower() != "false"


def merge_includes(found: Iterable[tuple[PossibleInclude, ...]]) -> Inclusions:
    """Merge the includes of all files by the included file."""
    tags: dict[str, list[Span]] = {}
    passed: dict[str, set[str]] = {}
    for includes in found:
        for include in includes:
            for path in include.files:
                tags.setdefault(path, []).append(include.span)
                passed.setdefault(path, set()).update(include.passes)
    return Inclusions(
        {path: tuple(spans) for path, spans in tags.items()}, {path: frozenset(names) for path, names in passed.items()}
    )


def _passed_by(include: Element, view: LaunchView) -> Iterator[str]:
    for child in include.elements:
        if child.name == "arg" and child.attributes.get("name"):
            yield child.attributes["name"]
    if passes_all(include):
        yield from view.declared
