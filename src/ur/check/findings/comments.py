"""Findings about the comments that hide findings: invalid ones, and those that hide nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from ur.check.findings.suppress import Suppression, Suppressions
from ur.check.rule import Rule
from ur.source.diagnostic import Diagnostic
from ur.source.suggest import did_you_mean


def check_comments(
    comments: Iterable[Suppression], used: Suppressions | None, rules: Mapping[str, Rule]
) -> Iterator[Diagnostic]:
    """Check comments; with `used`, after all rules have run, also report unused ones."""
    for each in comments:
        if each.problem:
            message = f"this comment hides nothing: {each.problem}"
            yield _finding(rules["bad-suppression"], message, each, "write ur: ignore RULE: REASON", "")
        for rule in each.rules:
            if rule not in rules:
                near = did_you_mean(rule, rules)
                help_ = f"did you mean {near}?" if near else "docs/reference/rules/index.md lists the rules"
                yield _finding(rules["bad-suppression"], f"there is no rule '{rule}'", each, help_, rule)
    for each, rule in used.unused() if used is not None else ():
        if rule in rules:
            message = f"nothing is found that this comment could hide for '{rule}'"
            help_ = "remove it, or `ur check --fix` does"
            yield _finding(rules["unused-suppression"], message, each, help_, rule)


def _finding(rule: Rule, message: str, each: Suppression, help_: str, subject: str) -> Diagnostic:
    return Diagnostic(rule.severity, message, rule.id, each.span, (), help_, subject)
