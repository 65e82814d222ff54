"""How resolving one tag ends when it cannot be resolved."""

from __future__ import annotations

from dataclasses import replace

from ur.source.diagnostic import Diagnostic, Note, Severity, error
from ur.source.file import Span


class Refused(Exception):  # noqa: N818 - carries a finding
    """A tag that roslaunch would refuse. Without a diagnostic it follows from one that was reported before."""

    def __init__(self, diagnostic: Diagnostic | None) -> None:
        super().__init__(diagnostic)
        self.diagnostic = diagnostic


def refuse(
    message: str,
    span: Span | None,
    rule: str,
    help: str | None = None,
    notes: tuple[Note, ...] = (),
    subject: str = "",
) -> Refused:
    """An exception to raise for a finding."""
    return Refused(error(message, span, rule=rule, help=help, notes=notes, subject=subject))


def as_warning(found: Diagnostic) -> Diagnostic:
    """The same finding as a warning: something that roslaunch accepts."""
    return replace(found, severity=Severity.WARNING)
