"""Make docs/reference/programs.md: the programs, on which bases they run, and what they publish there.

From the programs, the needs of their launch files, the bases, and the table of what the test of every
program on every base expects. A test compares the committed page with this; `tests/e2e/test_matrix.py` runs the cells.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))  # the table is the tests'

from tests.e2e.matrix_table import TABLE, Cell, list_all_bases, load_cells  # noqa: E402 - after the path

from ur.request.bases.base_argument import describe_base  # noqa: E402 - likewise

PAGE = ROOT / "docs" / "reference" / "programs.md"
_HEAD = """\
# Programs

Made by `tools/make_matrix.py`: edit the programs, the bases or `tests/e2e/matrix.yaml` instead.

`ur run NAME` starts a program on the selected robot; `rosrun ubiquity_launches NAME` does so, too, and after
`eval "$(ur env)"` so does `ur_NAME`. `ur help NAME` describes its arguments.

## On which base

A test runs every program on every base in the simulator, without a display, on ROS 1 and on ROS 2: every topic is
published at its rate, the frames are one tree, nothing is printed on standard error, and nothing is left at the end.
Where a base cannot do it, the program prints in one line what it lacks.
"""
_SHOWS = """\
## What they show

Topics are published where the base has what they need. Rates are in messages a second; a name is a field of the base's
file.
"""


def make_page() -> str:
    """The whole page."""
    bases = list_all_bases()
    cells = load_cells(bases)
    table = yaml.safe_load(TABLE.read_text(encoding="utf-8"))
    parts = [_HEAD, _render_matrix(cells), "", _SHOWS, *_render_topics(table)]
    return "\n".join(parts).rstrip() + "\n"


def _render_matrix(cells: Sequence[Cell]) -> str:
    lines = ["| program | | runs on |", "|---|---|---|"]
    for program in {cell.program.name: cell.program for cell in cells}.values():
        lacks: dict[str, list[str]] = {}
        for cell in cells:
            if cell.program.name == program.name and cell.lacks:
                reason = "no " + ", no ".join("/".join(need) for need in cell.lacks)
                lacks.setdefault(reason, []).append(describe_base(cell.base))
        without = "; ".join(f"not on {', '.join(bases)}: {reason}" for reason, bases in lacks.items())
        link = f"[`{program.name}`](../../ubiquity_launches/launches.md#ur_{program.name})"
        lines.append(f"| {link} | {program.summary} | {without or 'all bases'} |")
    return "\n".join(lines)


def _render_topics(table: Mapping[str, Any]) -> list[str]:
    users: dict[str, list[str]] = {}
    for name, row in table["programs"].items():
        for group in row["groups"]:
            users.setdefault(group, []).append(f"`{name}`")
    parts = []
    for group, entry in table["groups"].items():
        who = "every program" if len(users[group]) == len(table["programs"]) else ", ".join(users[group])
        lines = [f"**{group}** ({who})", "", "| topic | needs | rate |", "|---|---|---|"]
        lines += [
            f"| `{name}` | {each.get('needs', '')} | {_render_rate(each)} |" for name, each in entry["topics"].items()
        ]
        parts.append("\n".join(lines) + "\n")
    return parts


def _render_rate(entry: Mapping[str, Any]) -> str:
    if "rate" not in entry:
        return ""
    rate = f"`{entry['rate']}`" if isinstance(entry["rate"], str) else f"{entry['rate']:g}"
    if "per" in entry:
        rate += f" for each of `{entry['per']}`"
    return rate + (" at least" if entry.get("at_least") else "")


def main() -> None:
    """Write the page."""
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(make_page(), encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main()
