"""The occurrences of one argument: declaration, uses, and passed values in other files and programs.

With `pass_all_args`, an argument of the including file and that of the included one are the same.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Set

from ur.check.cases import resolve_cases
from ur.check.inclusion import IncludeFinder, list_includes, passes_all
from ur.check.rule import LaunchView
from ur.check.worlds import CachedWorld
from ur.launchfile.plan.specs import IncludeSpec
from ur.launchfile.query.written import ENDINGS, find_names
from ur.source.file import SourceFile, Span
from ur.tools.find.occurrences import Occurrence

_COMMENT = re.compile(r"\s*(\w+)\s*:")


def find_sharing_files(path: str, name: str, views: Mapping[str, LaunchView]) -> Set[str]:
    """Return the files that share an argument: `path`, and those that pass it on or get it by `pass_all_args`."""
    finder = IncludeFinder(views.values())
    links: dict[str, set[str]] = {}
    for view in views.values():
        for element in list_includes(view):
            if passes_all(element):
                for other in finder.files_of(element, view):
                    if name in view.declared and name in views[other].declared:
                        links.setdefault(view.path, set()).add(other)
                        links.setdefault(other, set()).add(view.path)
    found, waiting = {path}, [path]
    while waiting:
        new = links.get(waiting.pop(), set()) - found
        found |= new
        waiting.extend(new)
    return found


def find_argument(
    path: str, name: str, views: Mapping[str, LaunchView], programs: Iterable[SourceFile] = ()
) -> Iterator[Occurrence]:
    """Yield every occurrence of the argument `name` of the launch file `path`."""
    files = find_sharing_files(path, name, views)
    finder = IncludeFinder(views.values())
    for file in sorted(files):
        view = views[file]
        for element in view.declared.get(name, ()):
            yield Occurrence("arg", name, True, element.value_span("name"))
        yield from (Occurrence("arg", name, False, span) for span in view.used.get(name, ()))
        yield from _comments(view, name)
    for view in views.values():
        for include in list_includes(view):
            if files.isdisjoint(finder.files_of(include, view)):
                continue
            for child in include.elements:
                if child.name == "arg" and child.attributes.get("name") == name:
                    yield Occurrence("arg", name, False, child.value_span("name"), "handed on")
    yield from find_argument_texts(path, name, views)
    names = {file.rpartition("/")[2] for file in files}
    for source in programs:
        if any(each in source.text for each in names):
            for match in re.finditer(rf"(?<![\w$]){re.escape(name)}(?=:=)", source.text):
                yield Occurrence("arg", name, False, Span(source, *match.span()), "given")


def find_argument_texts(path: str, name: str, views: Mapping[str, LaunchView]) -> Iterator[Occurrence]:
    """Yield the occurrences in launch files that are programs, YAML, or tags without a tree."""
    for view in views.values():
        text = view.tree.source.text
        if name not in text or not (view.path.endswith(ENDINGS) or view.tree.for_other_launcher):
            continue
        if view.path != path and path.rpartition("/")[2] not in text:
            continue
        starts = {include.origin.span.start for include in _included(view) if include.file == path}
        for written in find_names(view.tree.source, name):
            if written.kind == "arg" and view.path == path:
                before = text[: written.span.start]
                declares = re.search(r"(DeclareLaunchArgument\(\s*(name\s*=\s*)?|<arg name=|name:\s*)['\"]?\Z", before)
                yield Occurrence("arg", name, declares is not None, written.span)
            elif written.kind == "passed" and written.around in starts:
                yield Occurrence("arg", name, False, written.span, "handed on")


def _included(view: LaunchView) -> tuple[IncludeSpec, ...]:
    return next(iter(resolve_cases(view, CachedWorld(view.world)))).plan.includes


def _comments(view: LaunchView, name: str) -> Iterator[Occurrence]:
    # <!--name: documentation-->
    for comment in view.tree.launch.comments if view.tree.launch is not None else ():
        match = _COMMENT.match(comment.text)
        if match and match.group(1) == name:
            start = comment.span.start + len("<!--") + match.start(1)
            yield Occurrence("arg", name, False, Span(comment.span.file, start, start + len(name)), "documented")
