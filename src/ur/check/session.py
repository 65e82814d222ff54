"""An incremental check: after a change, only the files that depend on it are checked again.

While a file is checked, its queries to the world are recorded. A change alters the answers to some of them; the files
with one of those queries are checked again, and the findings of all others stay.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from ur.check.cache.outline import IncludeOutline
from ur.check.cache.recall import CHECKED, Asked, Recall, describe_package, digest_of
from ur.check.catalogue import load_rules
from ur.check.collect import may_be_checked
from ur.check.findings.index import FindingIndex, FoundByUnit, Unit
from ur.check.findings.merge import Hit
from ur.check.findings.suppress import read_line_suppressions
from ur.check.plans import GAP, Given, PlanChecks
from ur.check.rule import LaunchView, Package, PackageView, ProgramView, YamlView
from ur.check.sources import CheckSources
from ur.check.survey import LaunchSurvey
from ur.check.visitor import Visitor
from ur.check.worlds import CachedWorld, Question
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, error
from ur.source.file import SourceFile, Span
from ur.source.progress import Progress, no_progress
from ur.source.suggest import did_you_mean

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
            self.world, self.rules, self._visitor, sources.views, sources.trees, sources.checked_as
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
            self._take_change(path)
        return True

    def _digest(self, question: Question) -> str:
        return digest_of(self.world.answer(question))

    def _take_change(self, path: str) -> None:
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
        return digest_of(before.world.answer(question)) == self._digest(question)

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
