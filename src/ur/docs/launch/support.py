"""Supported bases and variants of a launch file, and the unmet needs of the others."""

from collections.abc import Iterable, Iterator, Mapping

from ur.docs.cases.resolve import ResolvedCase
from ur.docs.documents import BaseCase, BaseDoc, SupportDoc
from ur.docs.repository.bases import find_lacks
from ur.docs.repository.collect import is_unknown
from ur.docs.words import Words
from ur.source.diagnostic import Diagnostic, Severity

# About this computer, or about what other tools say better; see ur check.
_NOT_HERE = frozenset({"unknown-package", "unset-variable", "unknown-machine", "duplicate-machine"})


def describe_support(
    outcomes: tuple[ResolvedCase, ...],
    needs: tuple[str, ...],
    bases: Mapping[str, BaseDoc],
    words: Words,
    *,
    has_variant: bool,
) -> tuple[tuple[SupportDoc, ...], tuple[str, ...]]:
    """Return the unmet needs in each case, and the problems in all of them.

    A file without an argument for the variant supports a base if one of its variants meets the needs.
    """
    wrong = {outcome.case: tuple(dict.fromkeys(_list_errors(outcome, words))) for outcome in outcomes}
    everywhere = tuple(text for text in wrong[outcomes[0].case] if all(text in texts for texts in wrong.values()))
    if not outcomes[0].case.base:
        return (), everywhere
    support = []
    for outcome in outcomes:
        lacks = _list_lacks(outcome.case, needs, bases, has_variant)
        errors = (text for text in wrong[outcome.case] if text not in everywhere or len(outcomes) == 1)
        support.append(SupportDoc(outcome.case, (*lacks, *errors)))
    return tuple(support), everywhere


def _list_lacks(
    case: BaseCase, needs: tuple[str, ...], bases: Mapping[str, BaseDoc], has_variant: bool
) -> tuple[str, ...]:
    base = bases.get(case.base)
    if base is None:
        return ()
    by_variant = {"": base.sensors, **dict(base.variants)}
    tried = [by_variant.get(case.variant, base.sensors)] if has_variant else list(by_variant.values())
    lacks = min((find_lacks(needs, features) for features in tried), key=len)
    return tuple(f"needs {' or '.join(need.split('|'))}" for need in lacks)


def _list_errors(outcome: ResolvedCase, words: Words) -> Iterator[str]:
    for found in outcome.default.plan.diagnostics:
        if found.severity is Severity.ERROR and found.rule not in _NOT_HERE and not is_unknown(found.message):
            yield describe_finding(found, words)


def describe_finding(found: Diagnostic, words: Words) -> str:
    """Describe a finding in one line, with its position."""
    message = words.show(found.message)
    if found.span is None:
        return message
    line = found.span.position.line
    return f"{message} ({words.show(found.span.file.path)}, line {line})"


def list_unreadable(findings: Iterable[Diagnostic], path: str, words: Words) -> tuple[str, ...]:
    """Return the errors that made it impossible to read a file."""
    return tuple(
        describe_finding(found, words)
        for found in findings
        if found.span is not None and found.span.file.path == path and found.severity is Severity.ERROR
    )
