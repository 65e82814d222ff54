"""`ur check --fix`: safe fixes of findings by their rules."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ur.check.rule import Rule, TextEdit
from ur.source.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Repair:
    """A file's new text, and the findings that it fixes."""

    path: str
    text: str
    findings: tuple[Diagnostic, ...]


def plan_repairs(findings: Iterable[Diagnostic], rules: Mapping[str, Rule]) -> list[Repair]:
    """Plan new texts for the files with fixable findings. Of two overlapping edits, the first is made."""
    edits: dict[str, list[tuple[TextEdit, Diagnostic]]] = {}
    for found in findings:
        rule = rules.get(found.rule)
        if rule is not None and rule.fix is not None and found.span is not None:
            for edit in rule.fix(found):
                edits.setdefault(edit.span.file.path, []).append((edit, found))
    return [_apply(path, group) for path, group in sorted(edits.items())]


def _apply(path: str, edits: list[tuple[TextEdit, Diagnostic]]) -> Repair:
    edits.sort(key=lambda pair: pair[0].span.start)
    source = edits[0][0].span.file.text
    parts, position, done = [], 0, []
    for edit, found in edits:
        if edit.span.start < position:
            continue
        parts += [source[position : edit.span.start], edit.text]
        position = edit.span.end
        done.append(found)
    return Repair(path, "".join(parts) + source[position:], tuple(done))
