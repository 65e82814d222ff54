"""Diagnostics: the common form of all findings."""

from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

from ur.source.file import Span


class Severity(Enum):
    """The severity of a finding. Errors prevent a program from working; warnings are about conventions."""

    ERROR = "error"
    WARNING = "warning"


class Note(NamedTuple):
    """A related position or fact: the first definition, a step of the include chain."""

    message: str
    span: Span | None = None


class _Diagnostic(NamedTuple):
    severity: Severity
    message: str
    rule: str
    span: Span | None = None
    notes: tuple[Note, ...] = ()
    help: str | None = None
    subject: str = ""
    kind: str = ""
    expected: tuple[str, ...] = ()
    reason: str = ""


class Diagnostic(_Diagnostic):
    """A finding: the subject and the problem, the expected value, the position, and one action that helps.

    `rule` is a kebab-case id whose meaning never changes. `span` is None if the finding is not in a text, for instance
    if it is about the command line. The fields after `help` are for programs, so that messages can be reworded freely:
    `subject` is the name that the finding is about: a package, an argument, a file; unless given, the text at its
    place, a tag without its angle bracket. `kind` distinguishes findings of one rule; `expected` are values that would
    be accepted; `reason` is the message without its subject.
    """

    __slots__ = ()
    if not TYPE_CHECKING:

        def __new__(cls, *fields, **named):
            made = super().__new__(cls, *fields, **named)
            if made.subject or made.span is None:
                return made
            text = made.span.text
            return made._replace(subject=text[1:] if text.startswith("<") and text[1:2].isalpha() else text)


class UserError(Exception):
    """Invalid input, with the reasons. It is the only exception for invalid user input that crosses a stage."""

    def __init__(self, *diagnostics: Diagnostic) -> None:
        super().__init__(*diagnostics)
        self.diagnostics = diagnostics

    def __str__(self) -> str:
        return "; ".join(f"{d.span}: {d.message}" if d.span else d.message for d in self.diagnostics)


def error(
    message: str,
    span: Span | None = None,
    *,
    rule: str,
    help: str | None = None,
    notes: tuple[Note, ...] = (),
    subject: str = "",
    kind: str = "",
    expected: tuple[str, ...] = (),
    reason: str = "",
) -> Diagnostic:
    """Return a Diagnostic with severity ERROR."""
    return Diagnostic(Severity.ERROR, message, rule, span, notes, help, subject, kind, expected, reason)


def user_error(
    message: str,
    span: Span | None = None,
    *,
    rule: str,
    help: str | None = None,
    notes: tuple[Note, ...] = (),
    subject: str = "",
) -> UserError:
    """Return a UserError with one error, see `error`."""
    return UserError(error(message, span, rule=rule, help=help, notes=notes, subject=subject))


def error_about(subject: object, reason: str, *, rule: str, help: str | None = None) -> Diagnostic:
    """Return an error without a position, whose message is the subject (a name or a path), a colon and the reason."""
    return error(f"{subject}: {reason}", rule=rule, help=help, subject=str(subject), reason=reason)


def user_error_about(subject: object, reason: str, *, rule: str, help: str | None = None) -> UserError:
    """Return a UserError with one error, see `error_about`."""
    return UserError(error_about(subject, reason, rule=rule, help=help))
