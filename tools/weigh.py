#!/usr/bin/env python3
"""Measure the size of the project, and compare it with what tests/weight.tsv allows.

    .venv/bin/python tools/weigh.py            # the sums, and exit code 1 where one is above its base and allowances
    .venv/bin/python tools/weigh.py --write    # lower the base rows where a sum has fallen

A scale is a part of the project with a sum: lines and code lines (without blank lines, comments and docstrings) of
Python in `source`, of programs and modules in `tests`, `bench` and `tools`, of `javascript` in src; words of `docs`;
`any`, the lines of src that name Any, and `patches`, the replacements of parts of the code by tests.
The sum of a scale may not exceed the sum of its base rows and its allowances, so code may move between packages.
Rows of tests/weight.tsv: `base SCALE SUBJECT LINES CODE`, and `allowance SCALE SUBJECT LINES` of a planned change.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.form.facts import Facts, is_python, read_facts, read_texts  # noqa: E402

RECORD = Path("tests", "weight.tsv")
SCALES = ("source", "javascript", "tests", "bench", "tools", "docs", "any", "patches")
UNITS = {"docs": "words", "any": "lines", "patches": "calls"}
"""Units of the scales with one figure; the others have lines and code lines."""
_HEAD = "kind\tscale\tsubject\tlines\tcode lines"


@dataclass(frozen=True, slots=True)
class Weight:
    """Lines (or what else a scale counts) and, in scales of code, lines of code."""

    lines: int = 0
    code: int = 0

    def __add__(self, other: Weight) -> Weight:
        return Weight(self.lines + other.lines, self.code + other.code)

    def exceeds(self, limit: Weight) -> bool:
        """Return whether one of the figures is above the other's."""
        return self.lines > limit.lines or self.code > limit.code

    def describe(self, scale: str) -> str:
        """Return the figures with their units."""
        unit = UNITS.get(scale)
        return f"{self.lines:,} {unit}" if unit else f"{self.lines:,} lines ({self.code:,} code lines)"


Table = Mapping[str, Mapping[str, Weight]]
"""The weights of the subjects (packages, folders) of each scale."""


@dataclass(frozen=True, slots=True)
class Record:
    """The content of tests/weight.tsv. An allowance is a scale, a subject and lines."""

    base: Table
    allowances: tuple[tuple[str, str, int], ...] = ()

    def limit(self, scale: str) -> Weight:
        """Return what a scale may weigh."""
        allowed = sum(lines for name, _, lines in self.allowances if name == scale)
        return total(self.base, scale) + Weight(allowed, 0 if scale in UNITS else allowed)


def total(table: Table, scale: str) -> Weight:
    """Return the sum of a scale."""
    return sum(table.get(scale, {}).values(), Weight())


def measure(facts: Mapping[str, Facts], root: Path = ROOT) -> Table:
    """Return the weights of a tree, with the facts of its Python files."""
    found: dict[str, dict[str, Weight]] = defaultdict(lambda: defaultdict(Weight))
    for scale, name, weight in (*_weigh_python(facts), *_weigh_others(root)):
        *folders, _ = name.split("/")
        subject = ".".join(folders[1:3]) if folders[:1] == ["src"] and scale != "docs" else "/".join(folders[:2])
        if weight != Weight():
            found[scale][subject or "."] += weight
    return found


def _weigh_python(facts: Mapping[str, Facts]) -> Iterator[tuple[str, str, Weight]]:
    for name, each in facts.items():
        top = name.partition("/")[0]
        yield "source" if top == "src" else top, name, Weight(each.lines, each.code_lines)
        if top == "src":
            yield "any", name, Weight(each.lines_with_any)
        elif top == "tests":
            yield "patches", name, Weight(each.patches)


def _weigh_others(root: Path) -> Iterator[tuple[str, str, Weight]]:
    for path, text in read_texts(root):
        name = path.relative_to(root).as_posix()
        top = name.partition("/")[0]
        is_script = path.suffix == ".js"
        if not is_python(path, text) and (is_script or top != "src"):
            lines = text.splitlines()
            code = _count_javascript(lines) if is_script else _count_shell(lines)
            yield "javascript" if top == "src" else top, name, Weight(len(lines), code)
    pages = [*root.glob("*.md"), *(root / "docs").rglob("*.md"), *(root / "src").rglob("*.md")]
    for path in pages:
        if path.name != "CHANGELOG.md":  # which grows with each change
            name = path.relative_to(root).as_posix()
            yield "docs", name, Weight(len(path.read_text(encoding="utf-8").split()))


def _count_shell(lines: Sequence[str]) -> int:
    return sum(bool(line.strip()) and not line.lstrip().startswith("#") for line in lines)


def _count_javascript(lines: Sequence[str]) -> int:
    code, inside = 0, False
    for line in map(str.strip, lines):
        inside = inside or line.startswith("/*")
        code += bool(line) and not inside and not line.startswith("//")
        inside = inside and "*/" not in line
    return code


def compare(record: Record, measured: Table) -> list[str]:
    """Return a text for each scale that is above its limit: by how much, where it grew, and what to do."""
    return [
        _describe_growth(record, measured, scale)
        for scale in SCALES
        if total(measured, scale).exceeds(record.limit(scale))
    ]


def _describe_growth(record: Record, measured: Table, scale: str) -> str:
    limit, base = record.limit(scale), record.base.get(scale, {})
    lines = [
        f"{scale} has {total(measured, scale).describe(scale)}, expected at most {limit.describe(scale)}, "
        "the base and its allowances"
    ]
    grown = {name: Weight(w.lines - (b := base.get(name, Weight())).lines, w.code - b.code)
             for name, w in measured.get(scale, {}).items() if w.exceeds(base.get(name, Weight()))}  # fmt: skip
    lines += [f"  {name} grew by {weight.describe(scale)}" for name, weight in sorted(grown.items())]
    row = f"allowance<tab>{scale}<tab>SUBJECT<tab>{UNITS.get(scale, 'lines').upper()}"
    help_ = f"take out as much in {scale}, or add the row that the issue of this change grants: {row}"
    return "\n".join([*lines, f"  help: {help_}"])


def lower(record: Record, measured: Table) -> Record:
    """Return the record with the measured rows of each scale whose sum has not risen, or that had no rows."""
    base = {}
    for scale in SCALES:
        before = record.base.get(scale, {})
        risen = before and total(measured, scale).exceeds(total(record.base, scale))
        base[scale] = before if risen else measured.get(scale, {})
    return replace(record, base=base)


def read_record(text: str) -> Record:
    """Return the record of a text. Raises ValueError for a line that is none."""
    base: dict[str, dict[str, Weight]] = defaultdict(dict)
    allowances = []
    for number, line in enumerate(text.splitlines(), 1):
        match line.split("\t"):
            case ["base", scale, subject, lines, code] if scale in SCALES:
                base[scale][subject] = Weight(int(lines), int(code))
            case ["allowance", scale, subject, lines] if scale in SCALES:
                allowances.append((scale, subject, int(lines)))
            case _ if line != _HEAD:
                raise ValueError(f"line {number}: {line!r}, expected a row of a scale: {', '.join(SCALES)}")
    return Record(base, tuple(allowances))


def write_record(record: Record) -> str:
    """Return the text of a record, allowances first."""
    rows = [_HEAD, *(f"allowance\t{scale}\t{subject}\t{lines}" for scale, subject, lines in record.allowances)]
    for scale in SCALES:
        weights = sorted(record.base.get(scale, {}).items())
        rows += [f"base\t{scale}\t{subject}\t{each.lines}\t{each.code}" for subject, each in weights]
    return "\n".join(rows) + "\n"


def main(arguments: Sequence[str], root: Path = ROOT) -> int:
    """Print, and compare or lower."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="lower the base rows where a sum has fallen")
    options = parser.parse_args(arguments)
    measured = measure(read_facts(root), root)
    record = read_record((root / RECORD).read_text(encoding="utf-8"))
    if options.write:
        record = lower(record, measured)
        (root / RECORD).write_text(write_record(record), encoding="utf-8")
    for scale in SCALES:
        sys.stdout.write(f"{scale:10}  {total(measured, scale).describe(scale)}")
        sys.stdout.write(f", at most {record.limit(scale).describe(scale)}\n")
    problems = compare(record, measured)
    sys.stdout.write("".join(f"error: {each}\n" for each in problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
