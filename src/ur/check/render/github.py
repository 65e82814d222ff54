"""A report as GitHub's workflow commands, which annotate the lines of a change.

Source of the format and of its escapes: GitHub's documentation, "Workflow commands for GitHub Actions".
"""

from ur.check.run import CheckReport
from ur.source.diagnostic import Diagnostic
from ur.source.printable import printable


def render_github(report: CheckReport) -> str:
    """Return one line per finding; empty without findings."""
    return "".join(_line(found) + "\n" for found in report.findings)


def _line(found: Diagnostic) -> str:
    text = found.message
    for note in found.notes:
        text += f"\nnote: {note.span}: {note.message}" if note.span else f"\nnote: {note.message}"
    if found.help:
        text += f"\nhelp: {found.help}"
    properties = {"title": found.rule}
    if found.span is not None:
        (line, column), (end_line, end_column) = found.span.position, found.span.file.position(found.span.end)
        properties = {"file": found.span.file.path, "line": str(line), "endLine": str(end_line), **properties}
        if end_line == line:  # columns of several lines are not allowed
            properties |= {"col": str(column), "endColumn": str(end_column)}
    listed = ",".join(f"{name}={_escape_property(value)}" for name, value in properties.items())
    return f"::{found.severity.value} {listed}::{_escape(text)}"


def _escape(text: str) -> str:
    return printable(text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A"))


def _escape_property(text: str) -> str:
    return _escape(text).replace(":", "%3A").replace(",", "%2C")
