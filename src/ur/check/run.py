"""The whole check: collect, read, visit, resolve, merge, and leave out what comments hide."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

from ur.check.cache.answers import CHECKED
from ur.check.cache.recall import Asked, NotedTrees, Recall, describe_package
from ur.check.cases import Resolved, list_cases, list_unknown, resolve_cases
from ur.check.catalogue import load_rules
from ur.check.collect import Targets, collect_targets, list_launch_files
from ur.check.findings.installed import judge_package
from ur.check.findings.merge import Hit, merge_hits
from ur.check.findings.suppress import Suppression, Suppressions, read_line_suppressions, read_xml_suppressions
from ur.check.inclusion import Inclusions, find_inclusions
from ur.check.rule import LaunchView, Package, PackageView, ProgramView, Rule, YamlView
from ur.check.survey import survey_launch_file, walk_elements
from ur.check.visitor import Visitor, stamp_severity
from ur.check.worlds import CachedWorld
from ur.launchfile.syntax import Element
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, Note, Severity, error
from ur.source.file import SourceFile, Span
from ur.source.progress import Progress, counted, no_progress
from ur.source.suggest import did_you_mean


@dataclass(frozen=True, slots=True)
class CheckReport:
    """The findings of a check, sorted by place, and the number of checked files."""

    findings: tuple[Diagnostic, ...]
    files: int
    suppressed: int
    left_out: tuple[str, ...] = ()  # links that lead out of what was checked

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
    `recall` holds findings of an earlier check, which spare work and change nothing, and gains those of this one.
    """
    cached = CachedWorld(world)
    targets = collect_targets(paths, cached)
    return _Check(targets, cached, load_rules(), chosen, arguments or {}, progress, recall).run()


class _Check:
    def __init__(
        self,
        targets: Targets,
        world: CachedWorld,
        rules: dict[str, Rule],
        chosen: frozenset[str] | None,
        arguments: Mapping[str, str],
        progress: Progress,
        recall: Recall | None,
    ) -> None:
        self.progress = progress
        self.recall = recall
        self.arguments = arguments
        self.targets = targets
        self.world = world
        self.rules = rules
        self.chosen = frozenset(rules) if chosen is None else chosen
        self.visitor = Visitor(rule for rule in rules.values() if rule.id in self.chosen)
        self.views: dict[str, LaunchView] = {}
        self.suppressions: dict[str, tuple[Suppression, ...]] = {}
        self.trees = NotedTrees(world)  # by absolute path: a file is parsed once, in all files that include it
        self.elements: dict[str, dict[int, Element]] = {}
        self.inclusions = Inclusions()
        self.yaml_files = frozenset(targets.yaml_files)
        self.asked = Asked(world, self.checked_as)

    def run(self) -> CheckReport:
        hits = list(self.check_everything())
        merged = [found for found in merge_hits(hits) if found.rule in self.chosen or found.rule not in self.rules]
        suppressions = Suppressions(self.suppressions)
        shown = [found for found in merged if not suppressions.hides(found)]
        hidden = len(merged) - len(shown)
        extra = [found for found in self.check_comments(suppressions) if found.rule in self.chosen]
        count = len(self.targets.launch_files) + len(self.targets.yaml_files) + len(self.targets.programs)
        findings = tuple(merge_hits(Hit(found) for found in (*shown, *extra)))
        return CheckReport(findings, count, hidden, self.targets.left_out)

    def check_everything(self) -> Iterator[Hit]:
        yield from self.read_launch_files()
        self.inclusions = find_inclusions((*self.views.values(), *self.read_neighbours()))
        yield from map(Hit, self.check_arguments())
        for view in counted(tuple(self.views.values()), "checking", "launch files", self.progress):
            yield from self.recall_launch_file(view) if self.recall is not None else self.check_launch_file(view)
        yield from self.check_yaml_files()
        programs: list[ProgramView] = []
        for path in counted(self.targets.programs, "checking", "programs", self.progress):
            package = self.targets.package_of(path)
            if package is not None and (source := self.read_text(path)) is not None:
                program = ProgramView(source, package, self.world, self.views)
                programs.append(program)
                yield from map(Hit, self.visitor.visit_program(program))
        for package in counted(self.targets.whole, "checking", "packages", self.progress):
            yield from map(Hit, self.visitor.visit_package(self.package_view(package, programs)))

    def read_launch_files(self) -> Iterator[Hit]:
        for path in counted(self.targets.launch_files, "reading", "launch files", self.progress):
            try:
                view = survey_launch_file(path, self.targets.package_of(path), self.world)
            except OSError as problem:
                yield Hit(_unreadable(path, problem))
                continue
            self.views[path] = view
            self.trees[path] = view.tree
            self.suppressions[path] = read_xml_suppressions(view.tree)

    def read_neighbours(self) -> Iterator[LaunchView]:
        # Other launch files of the same packages, which may include what is checked.
        packages = {view.package.folder: view.package for view in self.views.values() if view.package is not None}
        for folder, package in packages.items():
            self.progress(f"finding files that include them in {package.name}")
            for path in list_launch_files(folder, self.world):
                if path not in self.views:
                    with suppress(OSError):
                        yield survey_launch_file(path, package, self.world)

    def recall_launch_file(self, view: LaunchView) -> Iterable[Hit]:
        assert self.recall is not None
        passed = self.inclusions.passed.get(view.path)
        inputs = (
            describe_package(view.package),
            None if passed is None else sorted(passed),
            view.path in self.inclusions.tags,
            self.given_to(view),
            sorted(self.chosen),
        )
        return self.recall.hits_of(view.path, inputs, self.asked, partial(self.check_launch_file, view))

    def check_launch_file(self, view: LaunchView) -> Iterator[Hit]:
        yield from (Hit(found) for found in self.visitor.visit_launch_file(view) if not self.is_passed(found, view))
        yield from self.check_plans(view)

    def is_passed(self, found: Diagnostic, view: LaunchView) -> bool:
        passed = self.inclusions.passed.get(view.path, frozenset())
        return found.rule == "unused-argument" and found.subject in passed

    def check_arguments(self) -> Iterator[Diagnostic]:
        line = SourceFile("<command line>", " ".join(f"{name}:={value}" for name, value in self.arguments.items()))
        declared = {name for view in self.views.values() for name in view.declared}
        for name in self.arguments:
            if name in declared:
                continue
            start = line.text.index(f"{name}:=")
            near = did_you_mean(name, declared - set(self.arguments))
            help_ = f"did you mean {near}:=...?" if near else f"declared: {', '.join(sorted(declared)) or 'none'}"
            message = f"argument '{name}' is given, but no checked launch file declares it"
            yield error(message, Span(line, start, start + len(name)), rule="unknown-argument", help=help_)

    def check_plans(self, view: LaunchView) -> Iterator[Hit]:
        given = self.given_to(view)
        plain = frozenset(case.label for case in list_cases(view, given) if case.flipped is None)
        found_in: list[tuple[Diagnostic, str]] = []
        by_defaults = False
        for resolved in resolve_cases(view, self.world, given, trees=self.trees):
            by_defaults = by_defaults or resolved.by_defaults
            found_in.extend((found, resolved.case.label) for found in self.findings_of(resolved, view))
        if not found_in:
            return
        # A file that others include is judged there, with what they pass: here only what no argument changes.
        passed = self.inclusions.passed.get(view.path, frozenset())
        missing = {_place_of(found) for found, _ in found_in}
        if by_defaults or list_unknown(view) != list_unknown(view, passed):
            for resolved in resolve_cases(view, self.world, given, passed=passed, trees=self.trees):
                missing.difference_update(_place_of(found) for found in self.findings_of(resolved, view))
                if not missing:
                    break
        else:  # they would be the same plans again
            missing.clear()
        for found, label in found_in:
            included = found.rule == "unknown-machine" and view.path in self.inclusions.tags
            if _place_of(found) not in missing and not included:
                yield Hit(found, view.path, label, plain)

    def given_to(self, view: LaunchView) -> tuple[tuple[str, str], ...]:
        return tuple((name, value) for name, value in self.arguments.items() if name in view.declared)

    def findings_of(self, resolved: Resolved, view: LaunchView) -> Iterator[Diagnostic]:
        option = resolved.case.flipped
        for found in resolved.plan.diagnostics:
            if found.span is None:
                found = replace(found, span=Span(SourceFile(view.path, ""), 0, 0))
            found = self.settle(found, view)
            if found.severity is Severity.ERROR or self.is_checked(found):
                yield judge_package(stamp_severity(found, self.rules), view.package, option, self.world)
        element_at = partial(self.element_at, view)
        for found in self.visitor.visit_plan(resolved.plan, element_at, view.package, self.world):
            yield judge_package(found, view.package, option, self.world)

    def is_checked(self, found: Diagnostic) -> bool:
        path = found.span.file.path if found.span else ""
        self.world.note(CHECKED, path)
        return bool(self.checked_as(path))

    def checked_as(self, path: str) -> str:
        return "launch file" if path in self.views else "YAML file" if path in self.yaml_files else ""

    def settle(self, found: Diagnostic, view: LaunchView) -> Diagnostic:
        # Relative paths of included files become absolute, so that each file has one name.
        spans = [found.span, *(note.span for note in found.notes)]
        if all(span is None or span.file.path.startswith("/") for span in spans):
            return found
        notes = tuple(Note(note.message, self.settled_span(note.span, view)) for note in found.notes)
        return replace(found, span=self.settled_span(found.span, view), notes=notes)

    def settled_span(self, span: Span | None, view: LaunchView) -> Span | None:
        if span is None or span.file.path.startswith("/"):
            return span
        return Span(SourceFile(self.locate(span.file.path, view), span.file.text), span.start, span.end)

    def locate(self, path: str, view: LaunchView) -> str:
        return self.world.seen_from(view.path.rpartition("/")[0], self.world.environment).locate(path)

    def element_at(self, view: LaunchView, path: str, start: int) -> Element | None:
        path = path if path.startswith("/") else self.locate(path, view)
        self.world.note(CHECKED, path)
        seen = self.views.get(path)
        if seen is None or seen.tree.diagnostics:
            return None
        if path not in self.elements:
            self.elements[path] = {element.start: element for element, _ in walk_elements(seen.tree.launch)}
        return self.elements[path].get(start)

    def check_yaml_files(self) -> Iterator[Hit]:
        for path in counted(self.targets.yaml_files, "checking", "YAML files", self.progress):
            source = self.read_text(path)
            if source is None:
                continue  # what loads it reports it
            yield from map(Hit, self.visitor.visit_yaml_file(YamlView(source, self.targets.package_of(path))))

    def read_text(self, path: str) -> SourceFile | None:
        try:
            source = SourceFile(path, self.world.read_bytes(path).decode("utf-8"))
        except (OSError, UnicodeDecodeError):
            return None
        self.suppressions[path] = read_line_suppressions(source)
        return source

    def package_view(self, package: Package, programs: Iterable[ProgramView]) -> PackageView:
        return PackageView(
            package,
            tuple(view for view in self.views.values() if view.package is package),
            tuple(program for program in programs if program.package is package),
            self.inclusions.tags,
        )

    def check_comments(self, suppressions: Suppressions) -> Iterator[Diagnostic]:
        for each in (each for group in self.suppressions.values() for each in group):
            if each.problem:
                message = f"this comment hides nothing: {each.problem}"
                yield self.comment_finding("bad-suppression", message, each, "write ur: ignore RULE: REASON", "")
            for rule in each.rules:
                if rule not in self.rules:
                    near = did_you_mean(rule, self.rules)
                    help_ = f"did you mean {near}?" if near else "docs/reference/rules/index.md lists the rules"
                    yield self.comment_finding("bad-suppression", f"there is no rule '{rule}'", each, help_, rule)
        if self.chosen >= frozenset(self.rules):
            for each, rule in suppressions.unused():
                if rule in self.rules:
                    message = f"nothing is found that this comment could hide for '{rule}'"
                    yield self.comment_finding(
                        "unused-suppression", message, each, "remove it, or `ur check --fix` does", rule
                    )

    def comment_finding(self, rule: str, message: str, each: Suppression, help_: str, subject: str) -> Diagnostic:
        return Diagnostic(self.rules[rule].severity, message, rule, each.span, (), help_, subject)


def _place_of(found: Diagnostic) -> tuple[str, str, int]:
    return (found.rule, found.span.file.path, found.span.start) if found.span else (found.rule, "", 0)


def _unreadable(path: str, problem: OSError) -> Diagnostic:
    reason = (problem.strerror or str(problem)).lower()
    return error(
        f"{path}: {reason}, expected a readable text", Span(SourceFile(path, ""), 0, 0), rule="unreadable-file"
    )
