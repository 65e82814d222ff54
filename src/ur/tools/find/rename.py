"""Renaming of an argument in all files, verified by the plans: they differ only in that name."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from ur.check.cases import resolve_cases
from ur.check.rule import LaunchView, survey_launch_file
from ur.check.worlds import CachedWorld
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world import World
from ur.launchfile.world.overlay import OverlayWorld
from ur.source.diagnostic import UserError, error
from ur.source.file import SourceFile, Span
from ur.tools.find.arguments import find_argument, find_sharing_files
from ur.tools.format.run import describe_plan

_NAME = re.compile(r"[A-Za-z_]\w*\Z")


def rename_argument(
    path: str,
    old: str,
    new: str,
    views: Mapping[str, LaunchView],
    world: World,
    programs: Iterable[SourceFile] = (),
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
        return replace(plan, diagnostics=())
    includes = tuple(
        replace(each, arguments=tuple((old if name == new else name, value) for name, value in each.arguments))
        if each.file in files
        else each
        for each in plan.includes
    )
    return replace(plan, includes=includes, diagnostics=())


def _refuse(message: str, help_: str) -> None:
    raise UserError(error(message, rule="not-renamed", help=help_))
