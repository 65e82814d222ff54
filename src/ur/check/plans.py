"""Findings of launch files: of their trees, and of their plans in every case."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial

from ur.check.cache.recall import CHECKED, NotedTrees
from ur.check.cases import Resolved, list_cases, list_unknown, resolve_cases
from ur.check.findings.installed import judge_package
from ur.check.findings.merge import Hit
from ur.check.inclusion import Inclusions
from ur.check.rule import LaunchView, Rule
from ur.check.survey import walk_elements
from ur.check.visitor import Visitor, stamp_severity
from ur.check.worlds import CachedWorld, has_marker
from ur.launchfile.plan.problems import INHERITED
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Diagnostic, Note, Severity
from ur.source.file import SourceFile, Span

CheckedAs = Callable[[str], str]  # of a path: "launch file", "YAML file", or "" for what is not checked
Given = tuple[tuple[str, str], ...]
GAP = "unknown-value"
"""The rule of a value that is not known without running the file: for the report, not for the catalogue."""


@dataclass(frozen=True, slots=True)
class PlanChecks:
    """The check of launch files. `views` are the checked ones, `trees` all that have been read, by path."""

    world: CachedWorld
    rules: Mapping[str, Rule]
    visitor: Visitor
    views: Mapping[str, LaunchView]
    trees: NotedTrees
    checked_as: CheckedAs
    elements: dict[str, dict[int, Element]] = field(default_factory=dict)  # by path and offset; made when asked for

    def check_launch_file(self, view: LaunchView, inclusions: Inclusions, given: Given) -> Iterator[Hit | None]:
        """Yield the hits of one file, and None after each case, so that the caller can interrupt the work."""
        passed = inclusions.passed.get(view.path, frozenset())
        for found in self.visitor.visit_launch_file(view):
            if not (found.rule == "unused-argument" and found.subject in passed):
                yield Hit(found)
        yield from self._check_plans(view, inclusions, given)

    def _check_plans(self, view: LaunchView, inclusions: Inclusions, given: Given) -> Iterator[Hit | None]:
        plain = frozenset(case.label for case in list_cases(view, given) if case.flipped is None)
        found_in: list[tuple[Diagnostic, str]] = []
        by_defaults = False
        for resolved in resolve_cases(view, self.world, given, trees=self.trees):
            by_defaults = by_defaults or resolved.by_defaults
            found_in.extend((found, resolved.case.label) for found in self._findings_of(resolved, view))
            yield None
        if not found_in:
            return
        # A file that others include is checked with their arguments: here only findings that no argument changes.
        passed = inclusions.passed.get(view.path, frozenset())
        missing = {_place_of(found) for found, _ in found_in}
        if by_defaults or list_unknown(view) != list_unknown(view, passed):
            for resolved in resolve_cases(view, self.world, given, passed=passed, trees=self.trees):
                missing.difference_update(_place_of(found) for found in self._findings_of(resolved, view))
                if not missing:
                    break
                yield None
        else:  # they would be the same plans again
            missing.clear()
        for found, label in found_in:
            included = found.rule == "unknown-machine" and view.path in inclusions.tags
            if _place_of(found) not in missing and not included:
                yield Hit(_judge_inherited(found, view, inclusions), view.path, label, plain)

    def _findings_of(self, resolved: Resolved, view: LaunchView) -> Iterator[Diagnostic]:
        option = resolved.case.flipped
        for found in resolved.plan.diagnostics:
            if found.span is None:
                found = replace(found, span=Span(SourceFile(view.path, ""), 0, 0))
            found = self._settle(found, view)
            if found.severity is Severity.ERROR or self._is_checked(found):
                yield judge_package(stamp_severity(found, self.rules), view.package, option, self.world)
        places = {(found.span.file.path, found.span.start) for found in resolved.plan.diagnostics if found.span}
        for gap in resolved.plan.gaps:
            if gap.origin is not None and (gap.origin.span.file.path, gap.origin.span.start) in places:
                continue
            span = gap.origin.span if gap.origin is not None else Span(SourceFile(view.path, ""), 0, 0)
            found = Diagnostic(Severity.WARNING, gap.reason, GAP, self._settled_span(span, view))
            if not gap.kind and not has_marker(gap.reason) and self._is_checked(found):
                yield found
        element_at = partial(self._element_at, view)
        for found in self.visitor.visit_plan(resolved.plan, element_at, view.package, self.world, plain=option is None):
            yield judge_package(found, view.package, option, self.world)

    def _is_checked(self, found: Diagnostic) -> bool:
        path = found.span.file.path if found.span else ""
        self.world.note(CHECKED, path)
        return bool(self.checked_as(path))

    def _settle(self, found: Diagnostic, view: LaunchView) -> Diagnostic:
        # Relative paths of included files become absolute, so that each file has one name.
        spans = [found.span, *(note.span for note in found.notes)]
        if all(span is None or span.file.path.startswith("/") for span in spans):
            return found
        notes = tuple(Note(note.message, self._settled_span(note.span, view)) for note in found.notes)
        return replace(found, span=self._settled_span(found.span, view), notes=notes)

    def _settled_span(self, span: Span | None, view: LaunchView) -> Span | None:
        if span is None or span.file.path.startswith("/"):
            return span
        return Span(SourceFile(self._locate(span.file.path, view), span.file.text), span.start, span.end)

    def _locate(self, path: str, view: LaunchView) -> str:
        return self.world.seen_from(view.path.rpartition("/")[0], self.world.environment).locate(path)

    def _element_at(self, view: LaunchView, path: str, start: int) -> Element | None:
        path = path if path.startswith("/") else self._locate(path, view)
        self.world.note(CHECKED, path)
        seen = self.views.get(path)
        if seen is None or seen.tree.diagnostics:
            return None
        if path not in self.elements:
            self.elements[path] = {element.start: element for element, _ in walk_elements(seen.tree.launch)}
        return self.elements[path].get(start)


def _judge_inherited(found: Diagnostic, view: LaunchView, inclusions: Inclusions) -> Diagnostic:
    # A value that including files set: the file works as a part of those, and not alone.
    if found.kind != INHERITED or found.span is None or view.path not in inclusions.tags:
        return found
    if found.span.file.path != view.path:
        return found
    message = f"{found.message}: the file cannot be started alone"
    notes = (*found.notes, Note("it is included from here", inclusions.tags[view.path][0]))
    return replace(found, severity=Severity.WARNING, message=message, notes=notes)


def _place_of(found: Diagnostic) -> tuple[str, str, int]:
    return (found.rule, found.span.file.path, found.span.start) if found.span else (found.rule, "", 0)
