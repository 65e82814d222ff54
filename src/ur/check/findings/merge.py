"""Merging of findings: those that several cases of a file have in common are reported once."""

from collections.abc import Iterable
from typing import NamedTuple

from ur.launchfile.plan.problems import INHERITED
from ur.source.diagnostic import Diagnostic, Note, Severity

MAX_NOTES = 6


class Hit(NamedTuple):
    """A finding in one case of one file.

    `plain` are the cases of that file in which no option is changed. Without a `root` the finding is about a text, in
    any case.
    """

    found: Diagnostic
    root: str = ""
    label: str = ""
    plain: frozenset[str] = frozenset()


def merge_hits(hits: Iterable[Hit]) -> list[Diagnostic]:
    """Return one finding per rule and position, sorted by position; if not in every case, notes name the cases."""
    groups: dict[tuple[str, str, int, int], list[Hit]] = {}
    for hit in hits:
        groups.setdefault(_key(hit.found), []).append(hit)
    found = [_merge(group) for group in groups.values()]
    return sorted(_once_per_package(found), key=_order)


def _key(found: Diagnostic) -> tuple[str, str, int, int]:
    if found.span is None:
        return (found.rule, found.message, 0, 0)
    return (found.rule, found.span.file.path, found.span.start, found.span.end)


def _order(found: Diagnostic) -> tuple[str, int, int, str]:
    if found.span is None:
        return ("", 0, 0, found.rule)
    return (found.span.file.path, found.span.start, found.span.end, found.rule)


def _merge(group: list[Hit]) -> Diagnostic:
    first = max(group, key=lambda hit: len(hit.found.notes))  # the one with the chain of includes
    worst = min((hit.found.severity for hit in group), key=lambda severity: severity is Severity.WARNING)
    found = first.found._replace(severity=worst)
    same_root = [hit for hit in group if hit.root == first.root]
    always = first.plain <= {hit.label for hit in same_root} and len({hit.found.message for hit in same_root}) == 1
    if always or any(not hit.root for hit in group):
        return found
    messages: dict[str, list[str]] = {}
    for hit in same_root:
        messages.setdefault(hit.found.message, []).append(hit.label)
    notes = []
    for message, names in list(messages.items())[:MAX_NOTES]:
        with_ = ", or ".join(dict.fromkeys(names))
        notes.append(Note(f"with {with_}" + ("" if message == found.message else f": {message}")))
    if len(messages) > MAX_NOTES:
        notes.append(Note(f"and in {len(messages) - MAX_NOTES} more ways"))
    return found._replace(notes=(*notes, *found.notes))


def _once_per_package(found: list[Diagnostic]) -> Iterable[Diagnostic]:
    # A missing package or value of an including file is one finding per file, however often the file names it.
    groups: dict[tuple[str, str, str], list[Diagnostic]] = {}
    for finding in sorted(found, key=_order):
        of_whole_file = finding.rule in ("unknown-package", "package-not-installed") or finding.kind == INHERITED
        if finding.span is not None and of_whole_file:
            groups.setdefault((finding.rule, finding.span.file.path, finding.subject), []).append(finding)
        else:
            yield finding
    for group in groups.values():
        first, *others = group
        if others:
            lines = sorted({finding.span.position.line for finding in others if finding.span})
            where = ", ".join(str(line) for line in lines[:8]) + (", ..." if len(lines) > 8 else "")
            first = first._replace(notes=(*first.notes, Note(f"also in line {where}")))
        yield first
