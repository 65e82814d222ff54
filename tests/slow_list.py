"""The list of slow tests, tests/slow.tsv, from measured times: python -m tests.slow_list TIMES ... [--write].

`TIMES` are files of `pytest --times`, several runs of the same tests or of different ones; of a test the lowest time
counts. A test that takes more than LIMIT seconds of processor is slow. A slow test of tests/promises.tsv, which has one
for each promise of the README, is in the default suite all the same. Without `--write` the command prints what would
change, and fails where a test that is not in the list takes more than FAR seconds.
"""

import argparse
import sys
from collections import defaultdict
from collections.abc import Container, Mapping, Sequence
from pathlib import Path

TESTS = Path(__file__).parent
LIST = TESTS / "slow.tsv"
PROMISES = TESTS / "promises.tsv"
LIMIT = 0.3
"""Seconds of processor, with those of the processes that a test starts and of the fixtures that it shares."""
FAR = 15.0
"""Seconds at which a test is slow on any computer, also where it is the first to import something."""

Times = Mapping[str, float]


def read_rows(text: str) -> dict[str, float]:
    """Return the seconds of tests or of test functions, by their names, from lines `SECONDS<tab>NAME`."""
    rows = (line.split("\t") for line in text.splitlines() if line and not line.startswith(("#", "sum\t")))
    return {name: float(seconds) for seconds, name in rows}


def write_rows(rows: Times) -> str:
    """Return the text of a list, slowest first, with the sum of its seconds in the first line."""
    ordered = sorted((-round(seconds, 2), name) for name, seconds in rows.items())
    lines = [f"{-seconds:.2f}\t{name}\n" for seconds, name in ordered]
    return "".join([f"sum\t{-sum(seconds for seconds, _ in ordered):.2f}\n", *lines])


def read_promises(text: str) -> list[tuple[str, str]]:
    """Return the promises of the README, each with the name of a test, from lines `TEXT<tab>NAME`."""
    rows = [line.split("\t") for line in text.splitlines() if line and not line.startswith("#")]
    return [(promise, test) for promise, test in rows]


def function_of(test: str) -> str:
    """Return the name of a test without its parameters."""
    return test.partition("[")[0]


def name_of(nodeid: str) -> str:
    """Return pytest's name of a test as lists have it: on one line, in ASCII."""
    return nodeid.encode("unicode_escape").decode("ascii")


def is_listed(test: str, names: Container[str]) -> bool:
    """Return whether the names of a list have a test, or its function."""
    return test in names or function_of(test) in names


def lowest(runs: Sequence[Times]) -> dict[str, float]:
    """Return the lowest time of each test in several runs."""
    found: dict[str, float] = {}
    for run in runs:
        for test, seconds in run.items():
            found[test] = min(seconds, found.get(test, seconds))
    return found


def renew(rows: Times, measured: Times, limit: float = LIMIT) -> dict[str, float]:
    """Return the rows with what was measured in place of what they had for those tests.

    A function all of whose measured parameters are slow has one row with the sum of their seconds.
    """
    functions: dict[str, dict[str, float]] = defaultdict(dict)
    for test, seconds in measured.items():
        functions[function_of(test)][test] = seconds
    renewed = {name: seconds for name, seconds in rows.items() if function_of(name) not in functions}
    for function, tests in functions.items():
        slow = {test: seconds for test, seconds in tests.items() if seconds > limit}
        if slow and len(slow) == len(tests):
            renewed[function] = sum(slow.values())
        else:
            renewed |= slow
    return renewed


def main(arguments: Sequence[str]) -> int:
    """Compare the list with measured times, or write it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("times", type=Path, nargs="+", metavar="TIMES", help="a file of pytest --times")
    parser.add_argument("--write", action="store_true", help="write tests/slow.tsv")
    options = parser.parse_args(arguments)
    rows = read_rows(LIST.read_text(encoding="utf-8")) if LIST.exists() else {}
    measured = lowest([read_rows(path.read_text(encoding="utf-8")) for path in options.times])
    renewed = renew(rows, measured)
    if options.write:
        LIST.write_text(write_rows(renewed), encoding="utf-8")
    new = {name: seconds for name, seconds in renewed.items() if not is_listed(name, rows)}
    sys.stdout.write("".join(f"slow now: {seconds:.2f} s {name}\n" for name, seconds in sorted(new.items())))
    sys.stdout.write(f"{len(renewed)} rows, {sum(renewed.values()):.0f} s; LIMIT {LIMIT} s\n")
    far = [name for name, seconds in measured.items() if seconds > FAR and not is_listed(name, rows)]
    if far and not options.write:
        sys.stdout.write("".join(f"error: {name} takes {measured[name]:.1f} s of processor\n" for name in far))
        sys.stdout.write(
            f"  help: make it faster, or: .venv/bin/python -m tests.slow_list {options.times[0]} --write\n"
        )
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
