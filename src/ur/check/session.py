"""An incremental check: after a change, only the files that depend on it are checked again.

While a file is checked, its queries to the world are recorded. A change alters the answers to some of them; the files
with one of those queries are checked again, and the findings of all others stay.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

from ur.check.cache.recall import CHECKED, Asked, IncludeOutline, NotedTrees, Recall, describe_package, digest_of
from ur.check.cases import Resolved, list_cases, list_unknown, resolve_cases
from ur.check.catalogue import load_rules
from ur.check.collect import may_be_checked
from ur.check.findings.index import FindingIndex, FoundByUnit, Unit
from ur.check.findings.installed import judge_package
from ur.check.findings.merge import Hit
from ur.check.findings.suppress import read_line_suppressions
from ur.check.inclusion import Inclusions
from ur.check.rule import LaunchView, Package, PackageView, ProgramView, Rule, YamlView
from ur.check.sources import CheckSources
from ur.check.survey import LaunchSurvey, walk_elements
from ur.check.visitor import Visitor, stamp_severity
from ur.check.worlds import CachedWorld, Question, has_marker
from ur.launchfile.plan.problems import INHERITED
from ur.launchfile.syntax import Element
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, Note, Severity, error
from ur.source.file import SourceFile, Span
from ur.source.progress import Progress, no_progress
from ur.source.suggest import did_you_mean

CheckedAs = Callable[[str], str]  # of a path: "launch file", "YAML file", or "" for what is not checked
Given = tuple[tuple[str, str], ...]
GAP = "unknown-value"
"""The rule of a value that is not known without running the file: for the report, not for the catalogue."""


class PlanChecks(NamedTuple):
    """The check of launch files. `views` are the checked ones, `trees` all that have been read, by path."""

    world: CachedWorld
    rules: Mapping[str, Rule]
    visitor: Visitor
    views: Mapping[str, LaunchView]
    trees: NotedTrees
    checked_as: CheckedAs
    elements: dict[str, dict[int, Element]]  # by path and offset; made when asked for

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
                found = found._replace(span=Span(SourceFile(view.path, ""), 0, 0))
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
        return found._replace(span=self._settled_span(found.span, view), notes=notes)

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
    return found._replace(severity=Severity.WARNING, message=message, notes=notes)


def _place_of(found: Diagnostic) -> tuple[str, str, int]:
    return (found.rule, found.span.file.path, found.span.start) if found.span else (found.rule, "", 0)


_LAUNCH, _YAML, _PROGRAM, _PACKAGE = range(4)
_NOTHING: frozenset[str] = frozenset()
_COMMAND_LINE = "<command line>"


class CheckSession:
    """The findings of files, folders and packages, while they change.

    `steps` does the pending work; until it has ended, some findings are missing, or are those from before a change.
    Raises UserError for a bad path. `chosen`, `arguments` and `recall` are those of `check_paths`.
    """

    def __init__(
        self,
        paths: Sequence[str],
        world: World,
        chosen: frozenset[str] | None = None,
        arguments: Mapping[str, str] | None = None,
        progress: Progress = no_progress,
        recall: Recall | None = None,
    ) -> None:
        self.rules = load_rules()
        self.chosen = frozenset(self.rules) if chosen is None else chosen
        self._paths = paths
        self._arguments = arguments or {}
        self._progress = progress
        self._recall = recall
        self._visitor = Visitor(rule for rule in self.rules.values() if rule.id in self.chosen)
        self._index = FindingIndex(self.rules, self.chosen)
        self._todo: dict[Unit, None] = {}
        self._was_read = False
        self._begin(CheckSources(paths, world))

    def _begin(self, sources: CheckSources) -> None:
        self.sources = sources
        self._programs: dict[str, ProgramView] = {}
        self._asked = Asked(self.world, sources.checked_as)
        self._plans = PlanChecks(
            self.world, self.rules, self._visitor, sources.views, sources.trees, sources.checked_as, {}
        )

    @property
    def world(self) -> CachedWorld:
        """Return the world of the check, with its cached answers."""
        return self.sources.world

    # Changes

    def change(self, path: str) -> bool:
        """Record that the file at an absolute path has changed.

        Returns False if an incremental update is impossible, because the file is new, removed, or of another kind: see
        `renew`.
        """
        changed = self.world.find_changes(path)
        if changed is None or not self._was_read:
            return not may_be_checked(path)
        if ("is_file", path) in changed:
            return False
        if changed:
            take_back = self.world.forget_file(path)
            if not self.sources.stays_as_it_is(path):
                take_back()
                return False
            sources, targets = self.sources, self.sources.targets
            sources.trees.pop(path, None)
            self._plans.elements.pop(path, None)
            self._todo.update(dict.fromkeys(self._index.units_that_asked({("read_bytes", path)})))
            if path in sources.views or path in sources.neighbours:
                self._todo.update(((_LAUNCH, each), None) for each in sources.read_again(path))
                self._todo.update(((_PROGRAM, each), None) for each in targets.programs)
            if path in targets.programs:
                self._todo[_PROGRAM, path] = None
            elif kind := sources.checked_as(path):
                self._todo[_LAUNCH if kind == "launch file" else _YAML, path] = None
            self._index.comments.update({path: sources.comments[path]} if path in sources.comments else {})
            self._todo.update(((_PACKAGE, each.folder), None) for each in targets.whole)
        return True

    def renew(self, world: World) -> None:
        """Update after any change: files, packages and variables are those of `world` now.

        Raises UserError like the constructor.
        """
        before, unfinished = self.sources, frozenset(self._todo)
        self._begin(CheckSources(self._paths, world))
        views = {**before.views, **before.neighbours}
        known = {path: view.survey for path, view in views.items() if self._is_same(("read_bytes", path), before)}
        self._read(known)
        same: dict[Question, bool] = {}

        def stays(question: Question) -> bool:
            if question not in same:
                same[question] = self._is_same(question, before)
            return same[question]

        for unit, found in self._index.units():
            view = self.sources.views.get(unit[1]) if unit[0] == _LAUNCH else None
            if unit not in self._todo and not (unit[0] == _LAUNCH and unit[1] in self.sources.unreadable):
                self._index.store(unit, None)
            elif view is None or unit in unfinished or view.path not in known:
                continue
            elif found.inputs == self._inputs_of(view) and all(map(stays, found.asked)):
                del self._todo[unit]

    def _is_same(self, question: Question, before: CheckSources) -> bool:
        if question[0] == CHECKED:
            return before.checked_as(question[1]) == self.sources.checked_as(question[1])
        return digest_of(before.world.answer(question)) == digest_of(self.world.answer(question))

    # Work

    def steps(self, first: Sequence[str] = ()) -> Iterator[frozenset[str]]:
        """Do the pending work, starting with the files of `first`; yield files with changed findings after each unit.

        After a change, call it again: unfinished units start from their beginning.
        """
        if not self._was_read:
            self._read({})
        order = {path: number for number, path in enumerate(first)}
        todo = sorted(self._todo, key=lambda unit: (order.get(unit[1], len(order)), unit))
        number, launch_files = 0, sum(unit[0] == _LAUNCH for unit in todo)
        for unit in todo:
            if unit[0] == _LAUNCH:
                number += 1
                self._progress(f"checking {number} of {launch_files} launch files")
                yield from self._check_launch_file(self.sources.views[unit[1]])
            elif unit[0] == _YAML:
                yield from self._check_yaml_file(unit[1])
            else:
                yield self._store(unit, FoundByUnit(tuple(map(Hit, self._check_other(*unit)))))

    def _recall_outline(self, path: str) -> IncludeOutline | None:
        return self._recall.find_outline(path, self._asked) if self._recall is not None else None

    def _read(self, known: Mapping[str, LaunchSurvey]) -> None:
        self._was_read = True
        sources, targets = self.sources, self.sources.targets
        sources.read(known, self._recall_outline, self._progress)
        if self._recall is not None:
            for path, outline in sources.outlines.items():
                self._recall.keep_outline(path, outline, self._asked)
        self._index.comments = dict(sources.comments)
        for path, found in sources.unreadable.items():
            self._store((_LAUNCH, path), FoundByUnit((Hit(found),)))
        self._todo = dict.fromkeys((_LAUNCH, path) for path in sources.views)
        self._todo.update(((_YAML, path), None) for path in targets.yaml_files)
        self._todo.update(((_PROGRAM, path), None) for path in targets.programs)
        self._todo.update(((_PACKAGE, each.folder), None) for each in targets.whole)

    def _check_launch_file(self, view: LaunchView) -> Iterator[frozenset[str]]:
        return self._check_or_recall(
            (_LAUNCH, view.path),
            self._inputs_of(view),
            lambda: self._plans.check_launch_file(view, self.sources.inclusions, self._given_to(view)),
        )

    def _check_yaml_file(self, path: str) -> Iterator[frozenset[str]]:
        source, package = self._read_commented(path), self.sources.targets.package_of(path)
        if source is None:
            yield self._store((_YAML, path), FoundByUnit(()))
            return
        inputs = ("YAML file", describe_package(package), sorted(self.chosen))
        yield from self._check_or_recall(
            (_YAML, path),
            inputs,
            lambda: map(Hit, self._visitor.visit_yaml_file(YamlView(source, package, self.world))),
        )

    def _check_or_recall(
        self, unit: Unit, inputs: tuple[object, ...], begin: Callable[[], Iterator[Hit | None]]
    ) -> Iterator[frozenset[str]]:
        path = unit[1]
        known = self._recall.find(path, inputs, self._asked) if self._recall is not None else None
        hits, asked = known if known is not None else ([], set())
        if known is None:
            work = begin()
            done = False
            while not done:
                self.world.noted = asked
                try:
                    done = _take_hits(work, hits)
                finally:
                    self.world.noted = None
                if not done:
                    yield _NOTHING
            if self._recall is not None:
                self._recall.keep(path, inputs, self._asked, hits, asked)
        yield self._store(unit, FoundByUnit(tuple(hits), frozenset(asked), inputs))

    def _read_commented(self, path: str) -> SourceFile | None:
        # With its suppressions; None if it cannot be read, which its loader reports.
        source = self.sources.read_text(path)
        self._index.comments[path] = read_line_suppressions(source) if source is not None else ()
        return source

    def _check_other(self, kind: int, path: str) -> Iterable[Diagnostic]:
        if kind == _PACKAGE:
            return self._visitor.visit_package(self._package_view(self.sources.targets.packages[path]))
        source, package = self._read_commented(path), self.sources.targets.package_of(path)
        if source is None or package is None:
            return ()
        self._programs[path] = ProgramView(source, package, self.world, self.sources.views)
        return self._visitor.visit_program(self._programs[path])

    def _package_view(self, package: Package) -> PackageView:
        programs = tuple(each for _, each in sorted(self._programs.items()) if each.package is package)
        return PackageView(package, self.sources.views_of(package), programs, self.sources.inclusions.tags)

    def _inputs_of(self, view: LaunchView) -> tuple[object, ...]:
        inclusions = self.sources.inclusions
        passed = inclusions.passed.get(view.path)
        return (
            describe_package(view.package),
            None if passed is None else sorted(passed),
            view.path in inclusions.tags,
            self._given_to(view),
            sorted(self.chosen),
        )

    def _given_to(self, view: LaunchView) -> Given:
        return tuple((name, value) for name, value in self._arguments.items() if name in view.declared)

    def _store(self, unit: Unit, found: FoundByUnit) -> frozenset[str]:
        self._todo.pop(unit, None)
        return self._index.store(unit, found)

    # Findings

    def findings_of(self, path: str) -> tuple[list[Diagnostic], int]:
        """Return the findings in one file, sorted by position, and the number of hidden ones."""
        found, hidden = self._index.findings_of(path, self._check_arguments() if path == _COMMAND_LINE else ())
        rules = {each.id for each in self.rules.values() if each.only_parameters}
        if not rules.isdisjoint(each.rule for each in found) and not self._may_hold_parameters(path):
            found = [each for each in found if each.rule not in rules]
        return [each for each in found if each.rule != GAP], hidden

    def _may_hold_parameters(self, path: str) -> bool:
        is_yaml = bool(self.sources.views) and path in self.sources.targets.yaml_files
        loading = self._index.units_that_asked({("read_bytes", path)})
        return not is_yaml or any(unit[0] == _LAUNCH for unit in loading)

    def gaps_of(self, path: str) -> list[Diagnostic]:
        """Return the values in one file that are not known without running it, sorted by position."""
        return [each for each in self._index.findings_of(path)[0] if each.rule == GAP]

    @property
    def paths(self) -> list[str]:
        """Return the sorted files that may have findings; `""` for findings without a file."""
        return sorted({*self._index.paths(), _COMMAND_LINE})

    def _check_arguments(self) -> Iterator[Diagnostic]:
        line = SourceFile(_COMMAND_LINE, " ".join(f"{name}:={value}" for name, value in self._arguments.items()))
        views = self.sources.views.values() if self._arguments else ()  # which are not parsed without need
        declared = {name for view in views for name in view.declared}
        for name in self._arguments:
            if name in declared:
                continue
            start = line.text.index(f"{name}:=")
            near = did_you_mean(name, declared - set(self._arguments))
            help_ = f"did you mean {near}:=...?" if near else f"declared: {', '.join(sorted(declared)) or 'none'}"
            message = f"argument '{name}' is given, but no checked launch file declares it"
            yield error(message, Span(line, start, start + len(name)), rule="unknown-argument", help=help_)


def _take_hits(work: Iterator[Hit | None], hits: list[Hit]) -> bool:
    """Add hits up to the next pause; return True at the end."""
    for hit in work:
        if hit is None:
            return False
        hits.append(hit)
    return True


class CheckReport(NamedTuple):
    """The findings of a check, sorted by place, and the number of checked files."""

    findings: tuple[Diagnostic, ...]
    files: int
    suppressed: int
    left_out: tuple[str, ...] = ()  # links that lead out of what was checked
    gaps: tuple[Diagnostic, ...] = ()  # values that are not known without running the file

    @property
    def errors(self) -> int:
        """The number of findings that are errors."""
        return sum(found.severity is Severity.ERROR for found in self.findings)


def check_paths(
    paths: Sequence[str],
    world: World,
    chosen: frozenset[str] | None = None,
    arguments: Mapping[str, str] | None = None,
    progress: Progress = no_progress,
    recall: Recall | None = None,
) -> CheckReport:
    """Check files, folders and packages; `chosen` are rule ids (None: all). Raises UserError for a bad path.

    `arguments` are given to every launch file that declares them; the others keep their defaults or are unknown.
    `recall` contains findings of an earlier check, which save work without changing the result, and receives those of
    this one.
    """
    session = CheckSession(paths, world, chosen, arguments, progress, recall)
    return finish_report(session)


def finish_report(session: CheckSession) -> CheckReport:
    """Complete the work of a session, and report its findings."""
    for _ in session.steps():
        pass
    found = [session.findings_of(path) for path in session.paths]
    targets = session.sources.targets
    files = len(targets.launch_files) + len(targets.yaml_files) + len(targets.programs)
    findings = tuple(each for group, _ in found for each in group)
    gaps = tuple(each for path in session.paths for each in session.gaps_of(path))
    return CheckReport(findings, files, sum(hidden for _, hidden in found), targets.left_out, gaps)
