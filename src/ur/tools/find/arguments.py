"""The occurrences of one argument, and its renaming in all files, verified: the plans differ only in that name."""

import re
from collections.abc import Iterable, Iterator, Mapping, Set

from ur.check.cases import resolve_cases
from ur.check.inclusion import IncludeFinder, list_includes, passes_all
from ur.check.rule import LaunchView, survey_launch_file
from ur.check.worlds import CachedWorld
from ur.launchfile.plan.specs import IncludeSpec, Plan
from ur.launchfile.query.written import ENDINGS, find_names
from ur.launchfile.world import World
from ur.launchfile.world.overlay import OverlayWorld
from ur.source.diagnostic import user_error
from ur.source.file import SourceFile, Span
from ur.tools.find.search import Occurrence
from ur.tools.format.run import describe_plan

_NAME = re.compile(r"[A-Za-z_]\w*\Z")


def rename_argument(
    path: str, old: str, new: str, views: Mapping[str, LaunchView], world: World, programs: Iterable[SourceFile] = ()
) -> tuple[Span, ...]:
    """Return the spans that `new` has to replace. Raises UserError if that would change the meaning of a file.

    `path` is a launch file that declares the argument `old`; `views` are all files that may use it.
    """
    if not _NAME.match(new):
        _refuse(f"'{new}' is no name of an argument, expected letters, digits and _", "choose another name")
    files = find_sharing_files(path, old, views)
    for file in sorted(files):
        if new in views[file].declared or new in views[file].used:
            _refuse(f"{file} has an argument '{new}' already, expected an unused name", "choose another name")
    spans = tuple(each.span for each in find_argument(path, old, views, programs))
    texts = {path: text.encode("utf-8") for path, text in apply_rename(spans, new).items()}
    touched = [view for view in views.values() if view.path in texts or _reads(view, texts, views)]
    before, after = CachedWorld(world), CachedWorld(OverlayWorld(world, texts))
    for view in touched:
        if list(_plans(view, before, {}, new, old)) != list(_plans(view, after, files, new, old)):
            message = f"{view.path} would mean something else with '{new}' in place of '{old}'"
            _refuse(message, "rename it by hand where it is used, and compare with 'ur launch --dump json'")
    return spans


def apply_rename(spans: Iterable[Span], new: str) -> dict[str, str]:
    """Return the texts of all files with `new` in the spans."""
    by_file: dict[str, list[Span]] = {}
    for span in spans:
        by_file.setdefault(span.file.path, []).append(span)
    texts = {}
    for path, group in by_file.items():
        text = group[0].file.text
        for start, end in sorted({(each.start, each.end) for each in group}, reverse=True):
            text = text[:start] + new + text[end:]
        texts[path] = text
    return texts


def _reads(view: LaunchView, texts: Mapping[str, bytes], views: Mapping[str, LaunchView]) -> bool:
    # By name: a plan tells for sure, and takes longer.
    names = {path.rpartition("/")[2] for path in texts if path in views}
    return any(name in view.tree.source.text for name in names)


def _plans(view: LaunchView, world: CachedWorld, renamed: Iterable[str], new: str, old: str) -> Iterator[object]:
    files = frozenset(renamed)
    seen = survey_launch_file(view.path, view.package, world)
    for resolved in resolve_cases(seen, world):
        given = resolved.case.given
        if view.path in files:
            given = tuple((old if name == new else name, value) for name, value in given)
        yield sorted(given), describe_plan(_with_old_name(resolved.plan, files, new, old))


def _with_old_name(plan: Plan, files: frozenset[str], new: str, old: str) -> Plan:
    if not files:
        return plan._replace(diagnostics=())
    includes = tuple(
        each._replace(arguments=tuple((old if name == new else name, value) for name, value in each.arguments))
        if each.file in files
        else each
        for each in plan.includes
    )
    return plan._replace(includes=includes, diagnostics=())


def _refuse(message: str, help_: str) -> None:
    raise user_error(message, rule="not-renamed", help=help_)


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
