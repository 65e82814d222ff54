"""Exceptions for refused tags, and the kinds of their diagnostics."""

from ur.source.diagnostic import Diagnostic, Note, Severity, error
from ur.source.file import Span

# Kinds of diagnostics.
NOT_GIVEN = "not-given"  # a `missing-argument` of the file that is started, not of one that it includes
SPECIAL = "special"  # a `missing-file` that is there, as a device or a pipe
NOT_PYTHON = "not-python"  # a `bad-eval` that no argument can make right
INHERITED = "inherited"  # an `undeclared-argument` that an including file may declare
TOLERATED = "tolerated"  # the launcher accepts it
OBSOLETE = "obsolete"  # an `unknown-tag` that had a meaning once


class TagRefused(Exception):  # noqa: N818 - carries a finding
    """A tag that roslaunch would refuse. Without a diagnostic it results from an error that was already reported."""

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
    *,
    kind: str = "",
    expected: tuple[str, ...] = (),
) -> TagRefused:
    """Return an exception to raise for a finding."""
    found = error(message, span, rule=rule, help=help, notes=notes, subject=subject, kind=kind, expected=expected)
    return TagRefused(found)


def as_warning(found: Diagnostic) -> Diagnostic:
    """Return the same finding as a warning, for a mistake that roslaunch accepts."""
    return found._replace(severity=Severity.WARNING)
