"""Descriptions: what a launch file constructs, in the classes of the launch API, each with its position."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ur.launchfile.plan.specs import GapKind
from ur.source.file import Span


@dataclass(frozen=True, slots=True)
class Unknown:
    """A value that reading does not find out. `reason` and `kind` are those of a Gap."""

    reason: str
    span: Span | None = None
    kind: GapKind = ""

    def then(self, more: str, span: Span) -> Unknown:
        """Return what is not known because of this: `more` continues the reason. `span` is used without an own one."""
        return Unknown(f"{self.reason}; {more}", self.span or span, "" if self.kind == "command" else self.kind)


class Made:
    """An object that a launch file constructs: its class, and its arguments by name.

    `places` has the span of each argument as it was written. Most spans are never asked for: that of the object may be
    a function that finds it. The list `entities` of a LaunchDescription may grow while its file is read; nothing
    changes afterwards.
    """

    __slots__ = ("_span", "get", "kind", "places", "values")

    def __init__(
        self,
        kind: str,
        values: dict[str, object],
        span: Span | Callable[[], Span],
        places: Mapping[str, Span] | None = None,
    ) -> None:
        self.kind = kind
        self.values = values
        self.get: Callable[..., object] = values.get  # of an argument
        self._span = span
        self.places: Mapping[str, Span] = {} if places is None else places

    @property
    def span(self) -> Span:
        """The span of the object."""
        found = self._span
        if not isinstance(found, Span):
            found = self._span = found()
        return found

    def __repr__(self) -> str:
        return f"{self.kind} at {self.span}"

    def place(self, name: str) -> Span:
        """Return the span of an argument; of the object if the argument is not written."""
        found = self.places.get(name)
        return self.span if found is None else found


class DescriptionProblem(Exception):  # noqa: N818 - carries a finding to where its place is known
    """Something is wrong with a description: upstream would refuse it.

    The fields are those of a Diagnostic.
    """

    def __init__(
        self,
        message: str,
        rule: str,
        span: Span | None = None,
        help: str | None = None,
        subject: str = "",
        kind: str = "",
    ) -> None:
        super().__init__(message)
        self.kind = kind
        self.message, self.rule, self.span, self.help, self.subject = message, rule, span, help, subject


@dataclass(frozen=True, slots=True)
class Description:
    """One launch file, read: its LaunchDescription, which is None if there is none."""

    path: str
    launch: Made | None
    problems: tuple[DescriptionProblem, ...] = ()
    gaps: tuple[Unknown, ...] = ()
