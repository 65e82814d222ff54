"""Visitor of all checked files: each rule is called for every object that it has a hook for."""

from collections.abc import Callable, Iterable, Mapping

from ur.check.rule import (
    LaunchedNode,
    LaunchView,
    Package,
    PackageView,
    ParamView,
    PlanView,
    ProgramView,
    Rule,
    RuleFinding,
    RuleGroup,
    YamlView,
)
from ur.check.survey import walk_possible
from ur.check.worlds import CachedWorld
from ur.launchfile.plan.problems import OBSOLETE, TOLERATED
from ur.launchfile.plan.specs import Origin, Plan
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Diagnostic, Note

_AS_RESOLVED = frozenset({"bad-name"})  # some names are refused, and some only warned of
_Hook = tuple[Rule, Callable[..., Iterable[RuleFinding]]]


class Visitor:
    """Rules by the objects that they check. Those about conventions apply only to packages that follow them."""

    def __init__(self, rules: Iterable[Rule]) -> None:
        every = list(rules)
        self._element: list[_Hook] = [(rule, rule.element) for rule in every if rule.element]
        self._launch_file: list[_Hook] = [(rule, rule.launch_file) for rule in every if rule.launch_file]
        self._yaml_file: list[_Hook] = [(rule, rule.yaml_file) for rule in every if rule.yaml_file]
        self._program: list[_Hook] = [(rule, rule.program) for rule in every if rule.program]
        self._package: list[_Hook] = [(rule, rule.whole_package) for rule in every if rule.whole_package]
        self._node: list[_Hook] = [(rule, rule.node) for rule in every if rule.node]
        self._plan: list[_Hook] = [(rule, rule.plan) for rule in every if rule.plan]
        self._param: list[_Hook] = [(rule, rule.param) for rule in every if rule.param]

    def visit_launch_file(self, view: LaunchView) -> Iterable[Diagnostic]:
        """Apply the rules to a launch file's tree."""
        if view.tree.launch is None or view.tree.diagnostics:
            return  # a half-read file has no reliable findings
        for element in walk_possible(view.tree.launch):
            yield from _ask(self._element, view.package, element, view)
        yield from _ask(self._launch_file, view.package, view)

    def visit_plan(
        self,
        plan: Plan,
        element_at: Callable[[str, int], Element | None],
        package: Package | None,
        world: CachedWorld,
        *,
        plain: bool,
    ) -> Iterable[Diagnostic]:
        """Apply the rules to a resolved file. `element_at` returns the tag at a path and offset, or None.

        `plain`: no option has another value than by default.
        """
        if plain:
            yield from _ask(self._plan, package, PlanView(plan, element_at))
        machines = {machine.name for machine in plan.machines}
        for node in plan.all_nodes():
            element = element_at(node.origin.span.file.path, node.origin.span.start)
            if element is not None:
                local = node.machine not in machines or plan.is_local(node)
                node_view = LaunchedNode(node, element, local, package, world)
                yield from _with_includes(_ask(self._node, package, node_view), node.origin)
        for param in plan.programs:
            element = element_at(param.origin.span.file.path, param.origin.span.start)
            if element is not None:
                found = _ask(self._param, package, ParamView(param, element, package, world))
                yield from _with_includes(found, param.origin)

    def visit_yaml_file(self, view: YamlView) -> Iterable[Diagnostic]:
        """Apply the rules to a YAML file."""
        return _ask(self._yaml_file, view.package, view)

    def visit_program(self, view: ProgramView) -> Iterable[Diagnostic]:
        """Apply the rules to a program."""
        return _ask(self._program, view.package, view)

    def visit_package(self, view: PackageView) -> Iterable[Diagnostic]:
        """Apply the rules to a whole package."""
        return _ask(self._package, view.package, view)


def _ask(hooks: list[_Hook], package: Package | None, *what: object) -> Iterable[Diagnostic]:
    for rule, hook in hooks:
        if rule.group is RuleGroup.CONVENTIONS and (package is None or not package.follows_conventions):
            continue
        for found in hook(*what):
            yield Diagnostic(rule.severity, found.message, rule.id, found.span, found.notes, found.help, found.subject)


def _with_includes(findings: Iterable[Diagnostic], origin: Origin) -> Iterable[Diagnostic]:
    steps = tuple(Note("included from here", step) for step in reversed(origin.includes))
    return (found._replace(notes=(*found.notes, *steps)) for found in findings)


def stamp_severity(found: Diagnostic, rules: Mapping[str, Rule]) -> Diagnostic:
    """Return a finding of the resolver with the severity of its rule."""
    rule = rules.get(found.rule)
    if (
        rule is None
        or rule.severity is found.severity
        or found.kind == TOLERATED
        or found.rule in _AS_RESOLVED
        or (found.rule == "unknown-tag" and found.kind == OBSOLETE)  # many old files hold it
    ):
        return found
    return found._replace(severity=rule.severity)
