"""Errors in launch files caused by the value of an argument, reported about that command-line argument."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ur.launchfile.plan.problems import NOT_GIVEN
from ur.launchfile.plan.specs import Plan
from ur.source.arguments import Argument
from ur.source.diagnostic import Diagnostic, Severity, error
from ur.source.suggest import did_you_mean

# By rule, or by rule and kind: the expected value.
_EXPECTED = {
    ("bad-boolean", ""): "true or false",
    ("bad-number", ""): "a number",
    ("bad-number", "double"): "a number",
    ("bad-param-value", "double"): "a number",
    ("bad-param-value", "int"): "a whole number",
    ("bad-param-value", "bool"): "true or false",
    ("bad-param-value", "boolean"): "true or false",
}
_BOOLEANS = {"yes": "true", "on": "true", "y": "true", "no": "false", "off": "false", "n": "false"}


def blame_arguments(
    findings: Sequence[Diagnostic], given: Sequence[Argument], replan: Callable[[Sequence[Argument]], Plan]
) -> tuple[Diagnostic, ...]:
    """Return errors about the arguments that cause errors about values in launch files, one for each argument.

    An argument causes an error if the error vanishes with the argument's default. `replan` makes the plan with given
    arguments; it is called only if there is such an error.
    """
    blamed: list[Diagnostic] = []
    left, current = list(given), tuple(findings)
    for _ in given:  # an error may hide the one of an argument before it
        for argument in tuple(left):
            if not any(map(_expectation, current)):
                return tuple(blamed)
            others = [each for each in left if each.name != argument.name]
            without = replan(others).diagnostics
            places = set(map(_place, without))
            expected = next(
                (_expectation(each) for each in current if _expectation(each) and _place(each) not in places), ""
            )
            if expected and not any(found.kind == NOT_GIVEN for found in without):
                blamed.append(_about(argument, expected))
                left, current = others, without
    return tuple(blamed)


def _about(argument: Argument, expected: str) -> Diagnostic:
    help_ = None
    if expected == "true or false":
        near = _BOOLEANS.get(argument.value.lower()) or did_you_mean(argument.value, ("true", "false"))
        help_ = f"did you mean {argument.name}:={near}?" if near else f"for example {argument.name}:=false"
    return error(
        f"argument '{argument.name}' is '{argument.value}', expected {expected}",
        rule="bad-argument",
        help=help_,
        subject=argument.name,
    )


def _expectation(found: Diagnostic) -> str:
    return _EXPECTED.get((found.rule, found.kind), "") if found.severity is Severity.ERROR else ""


def _place(found: Diagnostic) -> tuple[str, str]:
    return found.rule, str(found.span or found.message)
