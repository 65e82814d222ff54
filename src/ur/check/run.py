"""The whole check: collect, read, visit, resolve, merge, and leave out what comments hide."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from ur.check.cases import Resolved, list_cases, resolve_cases
from ur.check.catalogue import load_rules
from ur.check.collect import Targets, collect_targets
from ur.check.merge import Hit, merge_hits
from ur.check.model import LaunchView, Package, PackageView, ProgramView, Rule, YamlView
from ur.check.suppress import Suppression, Suppressions, read_line_suppressions, read_xml_suppressions
from ur.check.survey import find_includers, survey_launch_file, walk_elements
from ur.check.visitor import Visitor, stamp_severity
from ur.check.worlds import CachedWorld
from ur.launchfile.syntax import Element
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, Severity, error
from ur.source.file import SourceFile, Span
from ur.source.suggest import did_you_mean


@dataclass(frozen=True, slots=True)
class Report:
    """What a check found, sorted by place, and how many files it looked at."""

    findings: tuple[Diagnostic, ...]
    files: int
    suppressed: int

    @property
    def errors(self) -> int:
        """How many findings are errors."""
        return sum(found.severity is Severity.ERROR for found in self.findings)


def check_paths(paths: Sequence[str], world: World, chosen: frozenset[str] | None = None) -> Report:
    """Check files, folders and packages; `chosen` are rule ids (None: all). Raises UserError for a bad path."""
    cached = CachedWorld(world)
    targets = collect_targets(paths, cached)
    return _Check(targets, cached, load_rules(), chosen).run()


class _Check:
    def __init__(
        self, targets: Targets, world: CachedWorld, rules: dict[str, Rule], chosen: frozenset[str] | None
    ) -> None:
        self.targets = targets
        self.world = world
        self.rules = rules
        self.chosen = frozenset(rules) if chosen is None else chosen
        self.visitor = Visitor(rule for rule in rules.values() if rule.id in self.chosen)
        self.views: dict[str, LaunchView] = {}
        self.suppressions: dict[str, tuple[Suppression, ...]] = {}
        self.elements: dict[str, dict[int, Element]] = {}

    def run(self) -> Report:
        hits = list(self.check_everything())
        merged = [found for found in merge_hits(hits) if found.rule in self.chosen or found.rule not in self.rules]
        suppressions = Suppressions(self.suppressions)
        shown = [found for found in merged if not suppressions.hides(found)]
        hidden = len(merged) - len(shown)
        extra = [found for found in self.check_comments(suppressions) if found.rule in self.chosen]
        count = len(self.targets.launch_files) + len(self.targets.yaml_files) + len(self.targets.programs)
        return Report(tuple(merge_hits(Hit(found) for found in (*shown, *extra))), count, hidden)

    def check_everything(self) -> Iterator[Hit]:
        yield from self.read_launch_files()
        for view in self.views.values():
            yield from map(Hit, self.visitor.visit_launch_file(view))
            yield from self.check_plans(view)
        yield from self.check_yaml_files()
        programs: list[ProgramView] = []
        for path in self.targets.programs:
            package = self.targets.package_of(path)
            if package is not None and (source := self.read_text(path)) is not None:
                program = ProgramView(source, package, self.world, self.views)
                programs.append(program)
                yield from map(Hit, self.visitor.visit_program(program))
        for package in self.targets.whole:
            yield from map(Hit, self.visitor.visit_package(self.package_view(package, programs)))

    def read_launch_files(self) -> Iterator[Hit]:
        for path in self.targets.launch_files:
            try:
                view = survey_launch_file(path, self.targets.package_of(path), self.world)
            except OSError as problem:
                yield Hit(_unreadable(path, problem))
                continue
            self.views[path] = view
            self.suppressions[path] = read_xml_suppressions(view.tree)

    def check_plans(self, view: LaunchView) -> Iterator[Hit]:
        cases = {case.label for case in list_cases(view) if case.flipped is None}
        for resolved in resolve_cases(view, self.world):
            label = resolved.case.label
            for found in self.findings_of(resolved, view):
                yield Hit(found, view.path, label, len(cases))

    def findings_of(self, resolved: Resolved, view: LaunchView) -> Iterator[Diagnostic]:
        option = resolved.case.flipped
        for found in resolved.plan.diagnostics:
            if found.span is None:
                continue
            ours = found.span.file.path in self.views or found.span.file.path in self.targets.yaml_files
            if ours or found.severity is Severity.ERROR:
                yield _judge(stamp_severity(found, self.rules), view.package, option)
        for found in self.visitor.visit_plan(resolved.plan, self.element_at, view.package, self.world):
            yield _judge(found, view.package, option)

    def element_at(self, path: str, start: int) -> Element | None:
        view = self.views.get(path)
        if view is None:
            return None
        if path not in self.elements:
            self.elements[path] = {element.start: element for element, _ in walk_elements(view.tree.launch)}
        return self.elements[path].get(start)

    def check_yaml_files(self) -> Iterator[Hit]:
        for path in self.targets.yaml_files:
            source = self.read_text(path)
            if source is None:
                yield Hit(_unreadable(path, OSError(0, "not readable as UTF-8 text")))
                continue
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
            find_includers(self.views.values()),
        )

    def check_comments(self, suppressions: Suppressions) -> Iterator[Diagnostic]:
        for each in (each for group in self.suppressions.values() for each in group):
            if each.problem:
                message = f"this comment hides nothing: {each.problem}"
                yield self.comment_finding("bad-suppression", message, each, "write ur: ignore RULE: REASON")
            for rule in each.rules:
                if rule not in self.rules:
                    near = did_you_mean(rule, self.rules)
                    help_ = f"did you mean {near}?" if near else "docs/reference/rules/index.md lists the rules"
                    yield self.comment_finding("bad-suppression", f"there is no rule '{rule}'", each, help_)
        if self.chosen >= frozenset(self.rules):
            for each, rule in suppressions.unused():
                if rule in self.rules:
                    message = f"nothing is found that this comment could hide for '{rule}'"
                    yield self.comment_finding(
                        "unused-suppression", message, each, "remove it, or `ur check --fix` does"
                    )

    def comment_finding(self, rule: str, message: str, each: Suppression, help_: str | None) -> Diagnostic:
        return Diagnostic(self.rules[rule].severity, message, rule, each.span, (), help_)


def _unreadable(path: str, problem: OSError) -> Diagnostic:
    reason = (problem.strerror or str(problem)).lower()
    return error(
        f"{path}: {reason}, expected a readable text", Span(SourceFile(path, ""), 0, 0), rule="unreadable-file"
    )


def _judge(found: Diagnostic, package: Package | None, option: str | None) -> Diagnostic:
    # A package that is not installed may be a matter of this computer, and not of the file.
    if found.rule != "unknown-package" or (found.help or "").startswith("did you mean"):
        return found
    name = found.message.split("'")[1]
    if package is not None and name in package.depends:
        why = "though package.xml depends on it"
    elif option is not None:
        why = f"and is needed when '{option}' is changed"
    else:
        return found
    return replace(
        found,
        rule="package-not-installed",
        severity=Severity.WARNING,
        message=f"package '{name}' is not installed here, {why}",
        help=f"install {name}; what the file takes from it is not checked until then",
    )
