"""Reports of a check: as text for display, as JSON for programs, and as GitHub's workflow commands."""

import json
from collections.abc import Sequence
from itertools import groupby
from textwrap import fill

from ur.check.findings.installed import NotInstalled, split_not_installed
from ur.check.session import CheckReport
from ur.source.diagnostic import Diagnostic, Note
from ur.source.file import SourceFile, Span
from ur.source.printable import printable
from ur.source.render import render_human

_WIDTH = 100
_GAPS = 3  # that a line names
_INSTALL = "'ur get --missing FOLDER' gets them; of packages built here: source their setup.bash"


def render_text(report: CheckReport, *, colour: bool = False) -> str:
    """Return the findings, one paragraph about packages that are not installed, and one line with counts."""
    findings, not_installed = split_not_installed(report.findings)
    nothing = "nothing else found" if not_installed.packages else "nothing found"
    text = render_human(findings, colour=colour) + _describe_gaps(report.gaps) + _describe_not_installed(not_installed)
    return text + summarise(report._replace(findings=findings), nothing=nothing) + "\n"


def _describe_gaps(gaps: Sequence[Diagnostic]) -> str:
    lines = []
    for path, group in groupby(gaps, key=lambda gap: gap.span.file.path if gap.span is not None else ""):
        found = list(group)
        first = "; ".join(f"line {gap.span.position.line}: {gap.message}" for gap in found[:_GAPS] if gap.span)
        more = f"; and {len(found) - _GAPS} more" if len(found) > _GAPS else ""
        subject = "1 value is" if len(found) == 1 else f"{len(found)} values are"
        lines.append(printable(f"{path}: note: {subject} not known without running it: {first}{more}") + "\n")
    return "".join(lines)


def _describe_not_installed(missing: NotInstalled) -> str:
    if not missing.packages:
        return ""
    subject = "1 package is" if len(missing.packages) == 1 else f"{len(missing.packages)} packages are"
    users = f"{_count(missing.files, 'file')} {'takes' if missing.files == 1 else 'take'}"
    names = printable(", ".join(missing.packages))
    text = f"{subject} not installed or not built here; what {users} from there is not checked: {names}"
    return fill(text, _WIDTH, subsequent_indent="  ", break_on_hyphens=False) + f"\n  help: {_INSTALL}\n"


def summarise(report: CheckReport, *, nothing: str = "nothing found") -> str:
    """Return `2 errors and 1 warning in 40 files`; `nothing` if there is no finding."""
    warnings = len(report.findings) - report.errors
    counts = [_count(number, word) for number, word in ((report.errors, "error"), (warnings, "warning")) if number]
    hidden = f" ({_count(report.suppressed, 'finding')} hidden by comments)" if report.suppressed else ""
    if not report.files:
        return "nothing was checked: no launch file, YAML file or program of a package is there"
    return f"{' and '.join(counts) or nothing} in {_count(report.files, 'file')}{hidden}"


def _count(number: int, word: str) -> str:
    return f"{number} {word}{'' if number == 1 else 's'}"


def shorten_paths(report: CheckReport, folder: str) -> CheckReport:
    """Return the same report with paths relative to a folder, if they are below it."""
    files: dict[int, SourceFile] = {}
    prefix = folder.rstrip("/") + "/"

    def move(span: Span | None) -> Span | None:
        if span is None or not span.file.path.startswith(prefix):
            return span
        file = files.setdefault(id(span.file), SourceFile(span.file.path.removeprefix(prefix), span.file.text))
        return Span(file, span.start, span.end)

    def moved(found: Diagnostic) -> Diagnostic:
        notes = tuple(Note(note.message.replace(prefix, ""), move(note.span)) for note in found.notes)
        help_ = found.help.replace(prefix, "") if found.help else None
        message = found.message.replace(prefix, "")
        return found._replace(span=move(found.span), notes=notes, message=message, help=help_)

    findings, gaps = tuple(map(moved, report.findings)), tuple(map(moved, report.gaps))
    return report._replace(findings=findings, gaps=gaps)


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


def render_json(report: CheckReport) -> str:
    """Return one object: `findings`, sorted by position, a `summary`, and values that are `not_known`.

    Lines and columns count from 1.
    """
    body = {
        "findings": [_finding(found) for found in report.findings],
        "summary": {
            "files": report.files,
            "errors": report.errors,
            "warnings": len(report.findings) - report.errors,
            "suppressed": report.suppressed,
        },
        "not_known": [{**place_of(gap.span), "message": gap.message} for gap in report.gaps],
    }
    return json.dumps(body, indent=2, ensure_ascii=False) + "\n"


def _finding(found: Diagnostic) -> dict[str, object]:
    return {
        **place_of(found.span),
        "severity": found.severity.value,
        "rule": found.rule,
        "message": found.message,
        "help": found.help,
        "notes": [{**place_of(note.span), "message": note.message} for note in found.notes],
    }


def place_of(span: Span | None) -> dict[str, object]:
    """Return path, line and column of the start, and line and column after the end; nulls without a position."""
    if span is None:
        return {"path": None, "line": None, "column": None, "end_line": None, "end_column": None}
    (line, column), (end_line, end_column) = span.position, span.file.position(span.end)
    return {"path": span.file.path, "line": line, "column": column, "end_line": end_line, "end_column": end_column}
