"""A report as SARIF 2.1.0, which code hosts and editors read.

Source of the format: OASIS, "Static Analysis Results Interchange Format (SARIF) Version 2.1.0".
"""

import json
from collections.abc import Mapping
from urllib.parse import quote

from ur.check.rule import Rule
from ur.check.run import CheckReport
from ur.source.diagnostic import Diagnostic
from ur.source.file import Span

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def render_sarif(report: CheckReport, rules: Mapping[str, Rule], version: str) -> str:
    """Return one run of the tool `ur check`, with the rules that have findings."""
    used = sorted({found.rule for found in report.findings})
    driver = {
        "name": "ur check",
        "version": version,
        "rules": [_rule(rules[id_]) if id_ in rules else {"id": id_} for id_ in used],
    }
    results = [_result(found, used.index(found.rule)) for found in report.findings]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    return json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2, ensure_ascii=False) + "\n"


def _rule(rule: Rule) -> dict[str, object]:
    return {
        "id": rule.id,
        "shortDescription": {"text": rule.summary},
        "fullDescription": {"text": rule.explanation.strip()},
        "defaultConfiguration": {"level": rule.severity.value},
    }


def _result(found: Diagnostic, index: int) -> dict[str, object]:
    text = found.message + (f"\n{found.help}" if found.help else "")
    result: dict[str, object] = {
        "ruleId": found.rule,
        "ruleIndex": index,
        "level": found.severity.value,
        "message": {"text": text},
        "locations": [_location(found.span)] if found.span else [],
    }
    related = [_location(note.span, note.message) for note in found.notes if note.span]
    if related:
        result["relatedLocations"] = related
    return result


def _location(span: Span, message: str | None = None) -> dict[str, object]:
    (line, column), (end_line, end_column) = span.position, span.file.position(span.end)
    region = {"startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column}
    path = span.file.path
    uri = ("file://" if path.startswith("/") else "") + quote(path)
    location: dict[str, object] = {"physicalLocation": {"artifactLocation": {"uri": uri}, "region": region}}
    if message is not None:
        location["message"] = {"text": message}
    return location
