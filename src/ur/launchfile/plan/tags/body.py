"""The body of `<launch>`: the tags in document order, groups, and included files."""

from collections.abc import Callable

from ur.launchfile.plan.draft import MAX_INCLUDES, Draft, TooMuch
from ur.launchfile.plan.problems import OBSOLETE, TagRefused, refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import IncludeSpec, MachineSpec
from ur.launchfile.plan.tags.arguments import check_passed, check_used, resolve_arg, trace_arg, warn_missing
from ur.launchfile.plan.tags.attributes import (
    as_flag,
    check_attributes,
    is_wanted,
    read_optional,
    read_required,
    resolve_namespace,
)
from ur.launchfile.plan.tags.nodes import resolve_node, resolve_test
from ur.launchfile.plan.tags.params import missing_file, resolve_param, resolve_rosparam
from ur.launchfile.plan.tags.simple import read_remap, resolve_env, resolve_machine
from ur.launchfile.plan.values.convert import CONDITIONS
from ur.launchfile.syntax import Element, LaunchFile
from ur.source.diagnostic import Note
from ur.source.suggest import did_you_mean

MAX_DEPTH = 200
INCLUDE_ATTRIBUTES = ("file", "ns", "clear_params", "pass_all_args")
GROUP_ATTRIBUTES = ("ns", "clear_params")
TAGS = ("arg", "env", "group", "include", "machine", "node", "param", "remap", "rosparam", "test")

_Machine = MachineSpec | None


def resolve_body(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    """Resolve the tags inside `<launch>` or `<group>`; return the default machine at its end.

    A refused tag is reported to the draft, and resolution continues with the next tag.
    """
    for child in element.elements:
        try:
            handler = _HANDLERS.get(child.name)
            if handler is None:
                _warn_unknown(child, draft, scope)
            elif ("if" not in child.attributes and "unless" not in child.attributes) or is_wanted(child, draft, scope):
                machine = handler(child, draft, scope, machine)
        except TagRefused as refused:  # noqa: PERF203 - the next tag is to be looked at
            draft.refuse(refused, scope)
            if child.name == "arg" and "name" in child.attributes:
                scope.poisoned.add(child.attributes["name"])
    return machine


def resolve_file(parsed: LaunchFile, draft: Draft, scope: Scope) -> bool:
    """Resolve a top-level file. Returns False if it cannot be resolved; the draft has the reasons."""
    for found in parsed.diagnostics:
        draft.add_diagnostic(found, ())
    if parsed.launch is None or parsed.diagnostics:
        return False
    try:
        check_launch_tag(parsed.launch, draft, None)
    except TagRefused as refused:
        draft.refuse(refused, None)
    resolve_body(parsed.launch, draft, scope, None)
    warn_missing(draft, scope)
    return True


def check_launch_tag(launch: Element, draft: Draft, scope: Scope | None) -> None:
    """Check the attributes of `<launch>` itself: `deprecated`, and a condition, which roslaunch ignores."""
    if "if" in launch.attributes and "unless" in launch.attributes:
        raise refuse(
            "<launch> with both 'if' and 'unless', expected none",
            launch.name_span("unless"),
            "bad-condition",
            "put the condition on the <include> of this file",
        )
    for name in ("if", "unless"):
        value = launch.attributes.get(name)
        if value is None:
            continue
        if "$" in value or value.lower().strip() not in ("true", "false", "1", "0"):
            raise refuse(
                f"'{name}' of <launch> is '{value}', expected true, false, 1 or 0",
                launch.value_span(name),
                "bad-boolean",
                "put the condition on the <include> of this file",
                expected=CONDITIONS,
            )
        draft.warn(
            f"'{name}' of <launch> has no effect, expected it on an <include> or <group>",
            launch.name_span(name),
            scope,
            "useless-condition",
            "put it on the <include> of this file",
        )
    if launch.attributes.get("deprecated"):
        draft.warn(
            f"this launch file is deprecated: {launch.attributes['deprecated']}",
            launch.value_span("deprecated"),
            scope,
            "deprecated-file",
        )


def _warn_unknown(element: Element, draft: Draft, scope: Scope) -> None:
    if element.name == "master":
        message = "<master> has no effect since ROS Diamondback"
        draft.warn(message, element.span, scope, "unknown-tag", "remove it", kind=OBSOLETE)
        return
    near = did_you_mean(element.name, TAGS)
    draft.warn(
        f"unknown tag <{element.name}>, expected one of {', '.join(TAGS)}",
        element.span,
        scope,
        "unknown-tag",
        f"did you mean <{near}>?" if near else "remove it: roslaunch ignores it with all that is inside",
    )


def _group(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    check_attributes(element, GROUP_ATTRIBUTES, draft, scope)
    namespace = resolve_namespace(element, draft, scope)
    child = scope.child(None)
    child.namespace = namespace
    child.params = list(child.params)
    return resolve_body(element, draft, child, machine)


def _include(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    check_attributes(element, INCLUDE_ATTRIBUTES, draft, scope)
    path = read_required(element, "file", draft, scope)
    pass_all = read_optional(element, "pass_all_args", draft, scope)
    passes_all = as_flag(pass_all, element, "pass_all_args") if pass_all is not None else False
    namespace = resolve_namespace(element, draft, scope)
    child = scope.include_child()
    child.namespace = namespace
    _pass_arguments(element, draft, scope, child, passes_all)
    check_passed(child)
    child.start_file(path, element.span)
    if not draft.follow:
        _note_include(path, draft.world.is_file(path), element, draft, scope, child)
        return machine
    included = _open(path, element, draft, scope, child)
    if included is None or included.launch is None:
        return machine
    draft.files[draft.world.absolute(path)] = None
    check_launch_tag(included.launch, draft, child)
    machine = resolve_body(included.launch, draft, child, machine)
    warn_missing(draft, child)
    if not passes_all:
        check_used(element, draft, child)
    return machine


def _pass_arguments(element: Element, draft: Draft, scope: Scope, child: Scope, passes_all: bool) -> None:
    child.pass_all_args = passes_all
    if passes_all and child.passing is not None:
        child.passing.update(scope.args)
        child.declared.update(dict.fromkeys(scope.args, element))
    failed = False
    for inner in element.elements:
        kind = inner.name.lower()
        try:
            if kind == "env":
                if is_wanted(inner, draft, child):
                    resolve_env(inner, draft, child, child)
            elif kind == "arg":
                if is_wanted(inner, draft, child):
                    resolve_arg(inner, draft, child)
                    trace_arg(inner, draft, child, passed_to=element.span)
            else:
                near = did_you_mean(kind, ("arg", "env"))
                draft.warn(
                    f"unknown tag <{inner.name}> inside <include>, expected <arg> or <env>",
                    inner.span,
                    scope,
                    "unknown-tag",
                    f"did you mean <{near}>?" if near else "put it beside the <include>, or into the included file",
                )
        except TagRefused as refused:
            draft.refuse(refused, scope)
            failed = True
            if "name" in inner.attributes:
                child.poisoned.add(inner.attributes["name"])
    if failed:
        child.poisoned.update(child.declared)


def _note_include(path: str, found: bool, element: Element, draft: Draft, scope: Scope, child: Scope) -> None:
    draft.includes.append(
        IncludeSpec(
            draft.world.absolute(path),
            found,
            draft.origin(element.span, scope),
            child.namespace,
            tuple(child.args.items()),
            child.pass_all_args,
        )
    )


def _open(path: str, element: Element, draft: Draft, scope: Scope, child: Scope) -> LaunchFile | None:
    if len(draft.includes) >= MAX_INCLUDES:
        draft.refuse(refuse(f"more than {MAX_INCLUDES:,} included files", element.span, "too-many-includes"), scope)
        raise TooMuch
    name = draft.world.absolute(path)
    if name in draft.endless:
        if any(draft.world.absolute(step.file.path) == name for step in scope.chain):
            raise TagRefused(None)
        draft.endless.remove(name)  # from outside of the circle, perhaps with arguments that end it
    if len(scope.chain) >= MAX_DEPTH:
        raise _too_deep(path, element, draft, scope)
    try:
        included = draft.parse(path)
    except OSError as problem:
        _note_include(path, False, element, draft, scope, child)
        raise missing_file(path, problem, element, "file", draft) from None
    _note_include(path, True, element, draft, scope, child)
    for found in included.diagnostics:
        draft.add_diagnostic(found, (*scope.chain, element.span))
    return included


def _too_deep(path: str, element: Element, draft: Draft, scope: Scope) -> TagRefused:
    name = draft.world.absolute(path)
    if first := next((step for step in scope.chain if draft.world.absolute(step.file.path) == name), None):
        draft.endless.add(name)
        return refuse(
            f"{path} includes itself, through {MAX_DEPTH} levels and more, expected an end",
            element.value_span("file"),
            "include-cycle",
            "break the circle, or end it with an 'if' that becomes false",
            (Note("it comes from here", first),),
            path,
        )
    return refuse(
        f"{path} is included {MAX_DEPTH} levels deep, expected less", element.value_span("file"), "include-too-deep"
    )


def _arg(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    resolve_arg(element, draft, scope)
    trace_arg(element, draft, scope)
    return machine


def _env(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    resolve_env(element, draft, scope, scope)
    return machine


def _machine(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    return resolve_machine(element, draft, scope) or machine


def _node(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    resolve_node(element, draft, scope, machine)
    return machine


def _param(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    resolve_param(element, draft, scope)
    return machine


def _remap(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    scope.add_remap(read_remap(element, draft, scope))
    return machine


def _rosparam(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    resolve_rosparam(element, draft, scope)
    return machine


def _test(element: Element, draft: Draft, scope: Scope, machine: _Machine) -> _Machine:
    resolve_test(element, draft, scope, machine)
    return machine


_HANDLERS: dict[str, Callable[[Element, Draft, Scope, _Machine], _Machine]] = {
    "arg": _arg,
    "env": _env,
    "group": _group,
    "include": _include,
    "machine": _machine,
    "node": _node,
    "param": _param,
    "remap": _remap,
    "rosparam": _rosparam,
    "test": _test,
}
