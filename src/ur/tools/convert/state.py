"""Findings of a conversion, and the remaps, variables and arguments in force at a place of a launch file."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

from ur.launchfile.syntax import Element
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span
from ur.tools.convert.expressions import NotConvertible, Want
from ur.tools.convert.texts import convert_text
from ur.tools.convert.yaml_out import XmlTag

RULE = "not-in-ros2"
_ARGUMENT = re.compile(r"\$\(arg\s+(\w+)\s*\)")
_DEEPEST = 3


@dataclass(slots=True)
class Findings:
    """Tags without a counterpart, and the loaded files by their paths as written, with whether they hold `$(...)`."""

    found: list[Diagnostic] = field(default_factory=list)
    files: dict[str, bool] = field(default_factory=dict)
    machines: list[Span] = field(default_factory=list)

    def add(self, message: str, span: Span, help: str) -> None:
        """Name something that ROS 2 has not, and what to do."""
        self.found.append(Diagnostic(Severity.WARNING, message, RULE, span, help=help))

    def finish(self) -> tuple[Diagnostic, ...]:
        """All findings, those of machines as one."""
        if self.machines:
            nodes = f"{len(self.machines)} nodes have" if len(self.machines) > 1 else "a node has"
            message = f"{nodes} machine=, which ros2 launch has not: it starts all on its own computer"
            self.add(message, self.machines[0], "start a launch file on each computer")
        return tuple(self.found)


@dataclass(frozen=True, slots=True)
class PlaceInFile:
    """Remaps and variables in force at a place, which later tags get, and `~` parameters for later nodes."""

    findings: Findings
    inherited: tuple[XmlTag, ...] = ()
    private: tuple[XmlTag, ...] = ()
    arguments: dict[str, XmlTag] = field(default_factory=dict)  # those that have no description yet
    defaults: dict[str, str] = field(default_factory=dict)  # of arguments, as they are written

    def resolve(self, text: str) -> str:
        """A text with the defaults of arguments in the place of their values, where these are known."""
        for _ in range(_DEEPEST):
            text = _ARGUMENT.sub(lambda found: self.defaults.get(found[1], found[0]), text)
        return text

    def with_inherited(self, tag: XmlTag) -> PlaceInFile:
        """The scope after a remap or a variable."""
        return replace(self, inherited=(*self.inherited, tag))

    def with_private(self, tags: list[XmlTag]) -> PlaceInFile:
        """The scope after `~` parameters."""
        return replace(self, private=(*self.private, *tags))


def convert_attribute(element: Element, name: str, findings: Findings) -> str | None:
    """The value of an attribute for ROS 2; None where it has none, or none that can be converted."""
    text = element.attributes.get(name)
    if text is None:
        return None
    return _attempt(text, "any", element.value_span(name), findings)


def _attempt(text: str, want: Want, span: Span, findings: Findings) -> str | None:
    try:
        return convert_text(text, want)
    except NotConvertible as problem:
        findings.add(f"{problem} cannot be converted", span, problem.help)
        return None


def conditions_of(element: Element, findings: Findings) -> dict[str, str]:
    """`if` and `unless` of a tag."""
    found: dict[str, str] = {}
    for name in ("if", "unless"):
        text = element.attributes.get(name)
        if text is not None:
            value = _attempt(text, "truth", element.value_span(name), findings)
            found |= {name: value} if value is not None else {}
    return found
