"""Findings by file and by the unit of work that found them, so that a part can be replaced."""

from collections.abc import Iterable, Iterator, Mapping, Set
from typing import NamedTuple

from ur.check.findings.merge import Hit, merge_hits
from ur.check.findings.suppress import Suppression, Suppressions, read_line_suppressions
from ur.check.rule import Rule
from ur.check.worlds import Question
from ur.source.diagnostic import Diagnostic
from ur.source.suggest import suggest

Unit = tuple[int, str]
"""A kind and a path: a file or package that is checked at once."""


class FoundByUnit(NamedTuple):
    """The hits of a unit, the queries that led to them, and its other inputs."""

    hits: tuple[Hit, ...]
    asked: frozenset[Question] = frozenset()
    inputs: object = None


class FindingIndex:
    """The findings of each unit. `comments` are those that hide findings, by path."""

    def __init__(self, rules: Mapping[str, Rule], chosen: Set[str]) -> None:
        self.comments: dict[str, tuple[Suppression, ...]] = {}
        self._rules = rules
        self._chosen = chosen
        self._found: dict[Unit, FoundByUnit] = {}
        self._units: dict[str, set[Unit]] = {}  # by the path that they found something in

    def store(self, unit: Unit, found: FoundByUnit | None) -> frozenset[str]:
        """Replace or remove the findings of a unit; return the paths whose findings may have changed."""
        before = self._found.pop(unit, None)
        touched = {_path_of(hit) for hit in before.hits} if before is not None else set()
        for path in touched:
            self._units[path].discard(unit)
        if found is not None:
            self._found[unit] = found
            for path in {_path_of(hit) for hit in found.hits}:
                self._units.setdefault(path, set()).add(unit)
                touched.add(path)
        return frozenset({*touched, unit[1]})

    def units(self) -> list[tuple[Unit, FoundByUnit]]:
        """Return all units with their findings."""
        return list(self._found.items())

    def units_that_asked(self, questions: Set[Question]) -> Iterator[Unit]:
        """Yield the units that depend on the answer to one of the queries."""
        return (unit for unit, found in self._found.items() if not found.asked.isdisjoint(questions))

    def paths(self) -> list[str]:
        """Return the sorted files that may have findings; `""` for findings without a file."""
        return sorted({"", *self._units, *self.comments})

    def findings_of(self, path: str, more: Iterable[Diagnostic] = ()) -> tuple[list[Diagnostic], int]:
        """Return the findings in one file, sorted by position, and the number of hidden ones.

        `more` are findings of no unit.
        """
        hits = [*map(Hit, more)]
        for unit in sorted(self._units.get(path, ())):
            hits.extend(hit for hit in self._found[unit].hits if _path_of(hit) == path)
        comments = self.comments.get(path, ())
        script = hits[0].found.span.file if hits and hits[0].found.span else None
        if script is not None and script.text.startswith("#!") and path not in self.comments:
            comments = read_line_suppressions(script)
        if not hits and not comments:
            return [], 0
        merged = [found for found in merge_hits(hits) if found.rule in self._chosen or found.rule not in self._rules]
        hiding = Suppressions({path: comments})
        shown = [found for found in merged if not hiding.hides(found)]
        used = hiding if self._chosen >= frozenset(self._rules) else None
        extra = [found for found in check_comments(comments, used, self._rules) if found.rule in self._chosen]
        return merge_hits(map(Hit, (*shown, *extra))), len(merged) - len(shown)


def _path_of(hit: Hit) -> str:
    return hit.found.span.file.path if hit.found.span is not None else ""


def check_comments(
    comments: Iterable[Suppression], used: Suppressions | None, rules: Mapping[str, Rule]
) -> Iterator[Diagnostic]:
    """Check comments; with `used`, after all rules have run, also report unused ones."""
    for each in comments:
        if each.problem:
            message = f"this comment hides nothing: {each.problem}"
            yield _finding(rules["bad-suppression"], message, each, "write ur: ignore RULE: REASON", "")
        for rule in each.rules:
            if rule not in rules:
                help_ = suggest(rule, rules) or "docs/reference/rules/index.md lists the rules"
                yield _finding(rules["bad-suppression"], f"there is no rule '{rule}'", each, help_, rule)
    for each, rule in used.unused() if used is not None else ():
        if rule in rules:
            message = f"nothing is found that this comment could hide for '{rule}'"
            help_ = "remove it, or `ur check --fix` does"
            yield _finding(rules["unused-suppression"], message, each, help_, rule)


def _finding(rule: Rule, message: str, each: Suppression, help_: str, subject: str) -> Diagnostic:
    return Diagnostic(rule.severity, message, rule.id, each.span, (), help_, subject)
