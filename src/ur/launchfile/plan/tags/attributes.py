"""Reading of a tag's attributes: substituted, checked, converted. Errors point at the attribute."""

from functools import cache

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.names import join_names, make_namespace
from ur.launchfile.plan.problems import NOT_GIVEN, TagRefused, refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.values.convert import CONDITIONS, read_boolean
from ur.launchfile.plan.values.substitute import MissingArgument, substitute
from ur.launchfile.syntax import Element, SubstitutionProblem
from ur.source.diagnostic import Note, error
from ur.source.file import Span
from ur.source.suggest import did_you_mean, suggest


@cache
def _known_names(known: tuple[str, ...]) -> frozenset[str]:
    return frozenset((*known, "if", "unless"))


def check_attributes(element: Element, known: tuple[str, ...], draft: Draft, scope: Scope) -> None:
    """Warn about attributes that roslaunch does not know and ignores."""
    if element.attributes.keys() <= _known_names(known):
        return
    for name in element.attributes:
        if name in known or name in ("if", "unless"):
            continue
        draft.warn(
            f"unknown attribute '{name}' of <{element.name}>, expected one of {', '.join(dict.fromkeys(known))}",
            element.name_span(name),
            scope,
            "unknown-attribute",
            suggest(name, [*known, "if", "unless"]) or "remove it: roslaunch ignores it",
        )


def read_optional(element: Element, name: str, draft: Draft, scope: Scope) -> str | None:
    """Return an attribute's value with `$(...)` replaced; None if it is missing. Raises TagRefused."""
    value = element.attributes.get(name)
    if not value or "$" not in value:
        return value
    return resolve_value(value, element, name, draft, scope)


def read_required(element: Element, name: str, draft: Draft, scope: Scope) -> str:
    """Return a required attribute as `read_optional` does. Raises TagRefused."""
    value = element.attributes.get(name)
    if value is None:
        raise missing_attribute(element, name)
    return value if "$" not in value else resolve_value(value, element, name, draft, scope)


def missing_attribute(element: Element, name: str) -> TagRefused:
    """Return the exception for a missing attribute."""
    near = did_you_mean(name, element.attributes)
    return refuse(
        f"<{element.name}> without attribute '{name}', expected one",
        element.span,
        "missing-attribute",
        f"did you mean {name} where it says {near}?" if near else f'add {name}="..."',
        subject=name,
    )


def resolve_value(value: str, element: Element, name: str, draft: Draft, scope: Scope, shift: int = 0) -> str:
    """Return a text in an attribute, `shift` characters from its start, with `$(...)` replaced. Raises TagRefused."""
    try:
        return substitute(value, scope, draft.world, draft.budget)
    except SubstitutionProblem as problem:
        span = element.piece_span(name, problem.start + shift, problem.end + shift)
        raise explain_problem(problem, span, scope) from None


def explain_problem(problem: SubstitutionProblem, span: Span, scope: Scope) -> TagRefused:
    """Turn a problem of a substitution into a finding."""
    if isinstance(problem, MissingArgument):
        return _explain_missing_argument(problem.name, span, scope)
    return refuse(problem.message, span, problem.rule, problem.help, subject=problem.subject, kind=problem.kind)


def _explain_missing_argument(name: str, span: Span, scope: Scope) -> TagRefused:
    if scope.passing is not None and scope.parent is not None:
        scope = scope.parent  # arguments of an <include> are resolved in the including file
    declaration = scope.declared.get(name)
    if declaration is None:
        help_ = (
            suggest(name, set(scope.declared) | set(scope.args))
            or f'declare it before it is used: <arg name="{name}" default="..."/>'
        )
        return refuse(
            f"argument '{name}' is not declared, expected <arg name=\"{name}\">",
            span,
            "undeclared-argument",
            help_,
            (),
            name,
        )
    scope.missing.pop(name, None)
    used = Note(f"'{name}' is used here", span)
    if not scope.chain:
        return refuse(
            f"argument '{name}' is required and was not given, expected {name}:=VALUE",
            declaration.value_span("name"),
            "missing-argument",
            f"give it on the command line: {name}:=VALUE",
            (used,),
            name,
            kind=NOT_GIVEN,
        )
    return TagRefused(
        error(
            f"argument '{name}' of {scope.filename} is required and was not passed",
            scope.chain[-1],
            rule="missing-argument",
            help=f'add <arg name="{name}" value="..."/> inside the <include>',
            notes=(Note(f"'{name}' is declared here", declaration.value_span("name")), used),
            subject=name,
        )
    )


def is_wanted(element: Element, draft: Draft, scope: Scope) -> bool:
    """Return whether `if` and `unless` enable a tag. Raises TagRefused if they are not booleans."""
    attributes = element.attributes
    if "if" not in attributes and "unless" not in attributes:
        return True
    condition = read_optional(element, "if", draft, scope)
    exception = read_optional(element, "unless", draft, scope)
    if condition is not None and exception is not None:
        raise refuse(
            f"<{element.name}> with both 'if' and 'unless', expected one of them",
            element.name_span("unless"),
            "bad-condition",
            'combine them: if="$(eval ... and not ...)"',
        )
    if condition is not None:
        return _condition(condition, element, "if")
    return not _condition(exception or "", element, "unless")


def _condition(value: str, element: Element, name: str) -> bool:
    try:
        return read_boolean(value)
    except ValueError as problem:
        raise refuse(
            f"'{name}' of <{element.name}> is '{value}', {problem}",
            element.value_span(name),
            "bad-boolean",
            expected=CONDITIONS,
        ) from None


def read_flag(element: Element, name: str, draft: Draft, scope: Scope) -> bool:
    """Return a boolean attribute: `true` or `false`, False if it is missing. Raises TagRefused, also for 1 and 0."""
    value = read_optional(element, name, draft, scope)
    if value is None:
        return False
    return as_flag(value, element, name)


def as_flag(value: str, element: Element, name: str) -> bool:
    """Parse `true` or `false` in any case. Raises TagRefused."""
    if value.lower() in ("true", "false"):
        return value.lower() == "true"
    raise refuse(
        f"'{name}' of <{element.name}> is '{value}', expected true or false",
        element.value_span(name),
        "bad-boolean",
        {"1": f'write {name}="true"', "0": f'write {name}="false"'}.get(value.strip()),
        expected=("true", "false"),
    )


def as_number(value: str, element: Element, name: str) -> float:
    """Parse a number. Raises TagRefused."""
    try:
        return float(value)
    except ValueError:
        raise refuse(
            f"'{name}' of <{element.name}> is '{value}', expected a number",
            element.value_span(name),
            "bad-number",
            kind="double",
        ) from None


def resolve_namespace(element: Element, draft: Draft, scope: Scope, node_name: str | None = None) -> str:
    """Return the namespace that `ns` gives a tag, and record `clear_params`. Raises TagRefused."""
    given: str | None = None
    if "ns" in element.attributes:
        given = read_optional(element, "ns", draft, scope)
        if not given:
            raise refuse(
                f"<{element.name}> with an empty 'ns', expected a namespace",
                element.name_span("ns"),
                "empty-namespace",
                "remove ns, or give it a name",
                subject=element.attributes["ns"],
            )
    try:
        namespace = scope.child_namespace(given)
    except ValueError as problem:
        raise refuse(f"'ns' of <{element.name}>: {problem}", element.value_span("ns"), "bad-name") from None
    clear = read_optional(element, "clear_params", draft, scope)
    if clear and as_flag(clear, element, "clear_params"):
        draft.clear_params.append(_cleared(element, namespace, given, node_name))
    return namespace


def _cleared(element: Element, namespace: str, given: str | None, node_name: str | None) -> str:
    if node_name is None:
        if given:
            return namespace
        raise refuse(
            f"<{element.name}> with 'clear_params' but without 'ns', expected both",
            element.name_span("clear_params"),
            "bad-clear-params",
            'add ns="...": it says what is cleared',
        )
    if not node_name:
        raise refuse(
            f"<{element.name}> with 'clear_params' but without a name, expected both",
            element.name_span("clear_params"),
            "bad-clear-params",
        )
    try:
        return make_namespace(join_names(namespace, node_name))
    except ValueError as problem:
        raise refuse(f"'name' of <{element.name}>: {problem}", element.value_span("name"), "bad-name") from None


def private_scope(element: Element, name: str, namespace: str, scope: Scope) -> Scope:
    """Return the scope in which a node's own <param> and <rosparam> are resolved. Raises TagRefused.

    As in roslaunch, it copies the names that $(anon) has created so far.
    """
    private = Scope(namespace, scope.filename, scope.args)
    try:
        private.namespace = private.child_namespace(name)
    except ValueError as problem:
        raise refuse(f"'name' of <{element.name}>: {problem}", element.value_span("name"), "bad-name") from None
    private.parent = scope
    private.anonymous = dict(scope.anonymous)
    private.declared = scope.declared
    private.missing = scope.missing
    private.poisoned = scope.poisoned
    private.chain = scope.chain
    return private
