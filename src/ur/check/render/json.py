"""A report as JSON, for programs."""

import json

from ur.check.run import CheckReport
from ur.source.diagnostic import Diagnostic
from ur.source.file import Span


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
