"""`<arg>`: declares arguments, and passes them to an included file."""

from typing import Literal

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.problems import NOT_GIVEN, TagRefused, as_warning, refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import ArgumentStep
from ur.launchfile.plan.tags.attributes import check_attributes, read_optional, read_required
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Note, error
from ur.source.file import Span
from ur.source.suggest import did_you_mean

ARG_ATTRIBUTES = ("name", "value", "default", "doc")


def resolve_arg(element: Element, draft: Draft, scope: Scope) -> None:
    """Declare an argument, or inside `<include>` pass one. Raises TagRefused."""
    name: str | None = None
    try:
        check_attributes(element, ARG_ATTRIBUTES, draft, scope)
        name = read_required(element, "name", draft, scope)
        value = read_optional(element, "value", draft, scope)
        default = read_optional(element, "default", draft, scope)
        if "doc" in element.attributes:
            read_optional(element, "doc", draft, scope)
        if value is not None and default is not None:
            raise refuse(
                f"argument '{name}' with both 'value' and 'default', expected one of them",
                element.name_span("default"),
                "arg-value-and-default",
                "value= cannot be overridden, default= can: keep the one you mean",
            )
        _add(element, name, value, default, scope)
    except TagRefused:
        if name is not None:
            scope.declared.setdefault(name, element)
            if scope.passing is not None:
                scope.passing.setdefault(name, "")
            else:
                scope.poisoned.add(name)
        raise


def _add(element: Element, name: str, value: str | None, default: str | None, scope: Scope) -> None:
    first = scope.declared.get(name)
    if first is not None:
        if not scope.pass_all_args:
            raise refuse(
                f"argument '{name}' is declared twice, expected once",
                element.value_span("name"),
                "duplicate-arg",
                "remove one of the two, or give each an 'if' and 'unless' that exclude the other",
                (Note(f"the first '{name}' is here", first.value_span("name")),),
            )
    else:
        scope.declared[name] = element
    args = scope.args if scope.passing is None else scope.passing
    if value is not None:
        if name in args and not scope.pass_all_args:
            raise _overridden(element, name, scope)
        args[name] = value
    elif default is not None:
        args.setdefault(name, default)
    elif name not in args and scope.passing is None and name not in scope.poisoned:
        scope.missing[name] = element


def _overridden(element: Element, name: str, scope: Scope) -> TagRefused:
    message = f"argument '{name}' has a fixed value here and cannot be given, expected default= instead of value="
    help_ = f"write default= in {scope.filename}, or do not pass '{name}'"
    place = element.value_span("name")
    if scope.chain:
        return refuse(
            message, place, "fixed-arg", help_, (Note(f"'{name}' is passed by this <include>", scope.chain[-1]),)
        )
    return refuse(message, place, "fixed-arg", help_)


def trace_arg(element: Element, draft: Draft, scope: Scope, passed_to: Span | None = None) -> None:
    """Record the effect of a resolved `<arg>`, if the caller wants a trace."""
    if draft.trace is None:
        return
    name = element.attributes.get("name", "")
    kind: Literal["value", "default", "required"] = "required"
    if "value" in element.attributes:
        kind = "value"
    elif "default" in element.attributes:
        kind = "default"
    args = scope.args if scope.passing is None else scope.passing
    written = element.attributes.get(kind, "")
    origin = draft.origin(element.span, scope)
    handed_over = name in scope.handed_over
    draft.trace.append(ArgumentStep(name, kind, written, args.get(name), origin, handed_over, passed_to))


def check_passed(scope: Scope) -> None:
    """Check after the children of an `<include>` that each argument has a value. Raises TagRefused."""
    for name, child in scope.declared.items():
        if scope.passing is not None and name not in scope.passing:
            raise refuse(
                f"argument '{name}' is passed without a value, expected value=\"...\"",
                child.span,
                "arg-without-value",
                f"write value=\"$(arg {name})\" to hand on your own '{name}'",
                subject=name,
            )


def check_used(element: Element, draft: Draft, scope: Scope) -> None:
    """Check after an included file that it declares every passed argument. Raises TagRefused."""
    unknown = [name for name in scope.handed_over if name not in scope.declared]
    if not unknown:
        return
    passed = {child.attributes.get("name"): child for child in element.elements if child.name.lower() == "arg"}
    found = []
    for name in unknown:
        child = passed.get(name)
        span = child.value_span("name") if child is not None else element.span
        near = did_you_mean(name, set(scope.declared) - set(scope.handed_over)) or did_you_mean(name, scope.declared)
        declared = ", ".join(sorted(scope.declared)) or "none"
        found.append(
            error(
                f"argument '{name}' is passed, but {scope.filename} does not declare it",
                span,
                rule="unknown-argument",
                help=f"did you mean {near}?" if near else f"remove it; that file declares: {declared}",
            )
        )
    for finding in found[:-1]:
        draft.add_diagnostic(finding, scope.chain[:-1])
    raise TagRefused(found[-1])


def warn_missing(draft: Draft, scope: Scope) -> None:
    """Warn at the end of a file about required arguments that are neither given nor used, which roslaunch accepts."""
    for name, element in scope.missing.items():
        note = (Note(f"'{name}' is declared here", element.value_span("name")),)
        if scope.chain:
            include, chain = scope.chain[-1], scope.chain[:-1]
            message = f"argument '{name}' of {scope.filename} is required and was not passed"
            help_ = f'add <arg name="{name}" value="..."/> inside the <include>'
            finding = error(message, include, rule="missing-argument", notes=note, help=help_, subject=name)
        else:
            chain = ()
            message = f"argument '{name}' is required and was not given, expected {name}:=VALUE"
            place = element.value_span("name")
            help_ = f"give it on the command line: {name}:=VALUE"
            finding = error(message, place, rule="missing-argument", help=help_, subject=name, kind=NOT_GIVEN)
        draft.add_diagnostic(as_warning(finding), chain)
