"""Count what ties the code of nodes to threads and to the middleware, and compare it with what has been recorded.

    .venv/bin/python tools/measure_nodes.py            # what counts, and exit code 1 where there is more than recorded
    .venv/bin/python tools/measure_nodes.py --write    # lower the record, in tests/ur_nodes/wiring.tsv

Two figures of each file in src/ur_nodes may only fall: the locks, conditions, events, queues and threads that it makes,
and the lines of a `*_node.py`, which only connects a node to ROS, as far as they exceed 80. A file that is not in the
record may have none of the one and 80 of the other; `--write` accepts it as long as the sum of all files does not rise,
so that code can move.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
NODES = ROOT / "src" / "ur_nodes"
RECORD = ROOT / "tests" / "ur_nodes" / "wiring.tsv"
FREE_LINES = 80
"""Lines that a `*_node.py` may have without a record."""
MADE = {
    "threading": {"Barrier", "BoundedSemaphore", "Condition", "Event", "Lock", "RLock", "Semaphore", "Thread", "Timer"},
    "queue": {"LifoQueue", "PriorityQueue", "Queue", "SimpleQueue"},
    "rospy": {"Timer"},
    "futures": {"ThreadPoolExecutor"},
}
_HEAD = "file\tlocks and threads\tlines above 80\n"


@dataclass(frozen=True, slots=True)
class Wiring:
    """What a file makes of locks and threads, and the lines of a node above FREE_LINES."""

    threads: int
    lines: int

    def exceeds(self, limit: Wiring) -> bool:
        """Return whether one of the figures is above the other's."""
        return self.threads > limit.threads or self.lines > limit.lines

    def lowered_to(self, other: Wiring) -> Wiring:
        """Return the lower of both figures."""
        return Wiring(min(self.threads, other.threads), min(self.lines, other.lines))


NOTHING = Wiring(0, 0)
Table = Mapping[str, Wiring]


def count_threads(text: str) -> int:
    """Return how many locks, threads, ... a module makes, or hands on to be made; annotations do not count."""
    tree = ast.parse(text)
    imported = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if alias.name in MADE.get(str(node.module).rpartition(".")[2], ())
    }
    return sum(_is_made(node, imported) for node in _walk_values(tree))


def _walk_values(node: ast.AST) -> Iterator[ast.AST]:
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns"):
            continue
        for each in value if isinstance(value, list) else [value]:
            if isinstance(each, ast.AST):
                yield each
                yield from _walk_values(each)


def _is_made(node: ast.AST, imported: set[str]) -> bool:
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
        return node.attr in MADE.get(node.value.id, ())
    return isinstance(node, ast.Name) and node.id in imported


def measure(files: Iterable[Path], top: Path) -> dict[str, Wiring]:
    """Return the figures of the files that have any, by their paths below `top`."""
    found = {}
    for path in sorted(files):
        text = path.read_text(encoding="utf-8")
        lines = text.count("\n") - FREE_LINES if path.stem.endswith("_node") else 0
        wiring = Wiring(count_threads(text), max(lines, 0))
        if wiring != NOTHING:
            found[path.relative_to(top).as_posix()] = wiring
    return found


def read_record(text: str) -> dict[str, Wiring]:
    """Return a record. A file with several lines, as a merge may leave them, has the lowest figures of these."""
    found: dict[str, Wiring] = {}
    for line in text.splitlines():
        if line + "\n" != _HEAD and line:
            name, threads, lines = line.split("\t")
            wiring = Wiring(int(threads), int(lines))
            found[name] = found.get(name, wiring).lowered_to(wiring)
    return found


def write_record(table: Table) -> str:
    """Return the text of a record, a line a file."""
    return _HEAD + "".join(f"{name}\t{each.threads}\t{each.lines}\n" for name, each in sorted(table.items()))


def find_risen(recorded: Table, measured: Table) -> list[str]:
    """Return a line for each file whose figures are above those of the record."""
    return [
        f"{name} makes {each.threads} locks and threads and has {each.lines} lines above {FREE_LINES}, "
        f"expected at most {limit.threads} and {limit.lines}"
        for name, each in sorted(measured.items())
        if each.exceeds(limit := recorded.get(name, NOTHING))
    ]


def lower(recorded: Table, measured: Table) -> dict[str, Wiring]:
    """Return the record with the lower figures, and with new files as long as no sum rises."""
    lowered = {name: recorded.get(name, each).lowered_to(each) for name, each in measured.items()}
    sums = [Wiring(sum(w.threads for w in table.values()), sum(w.lines for w in table.values()))
            for table in (lowered, recorded)]  # fmt: skip
    if sums[0].exceeds(sums[1]):
        return {name: each for name, each in lowered.items() if name in recorded and each != NOTHING}
    return {name: each for name, each in lowered.items() if each != NOTHING}


def main(arguments: Sequence[str]) -> int:
    """Print, and compare or lower."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="lower the record")
    options = parser.parse_args(arguments)
    measured = measure(NODES.rglob("*.py"), NODES)
    recorded = read_record(RECORD.read_text(encoding="utf-8"))
    if options.write:
        recorded = lower(recorded, measured)
        RECORD.write_text(write_record(recorded), encoding="utf-8")
    for name, each in sorted(measured.items(), key=lambda item: (item[1].lines, item[1].threads), reverse=True):
        sys.stdout.write(f"{each.lines + FREE_LINES if each.lines else '':>4} {each.threads:3}  {name}\n")
    threads, lines = sum(w.threads for w in measured.values()), sum(w.lines for w in measured.values())
    sys.stdout.write(f"lines of nodes above {FREE_LINES}: {lines}, locks and threads: {threads}\n")
    risen = find_risen(recorded, measured)
    sys.stdout.write("".join(f"error: {line}\n" for line in risen))
    return 1 if risen else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
