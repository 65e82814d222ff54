"""Keep the list of tests that failed and then passed on a second try, and fail once one has been in it for too long.

    .venv/bin/python tools/second_tries.py               # print the list; exit code 1 when a test is in it for 14 days
    .venv/bin/python tools/second_tries.py --add FILE    # add the tests of pytest's lastfailed, with the date

The list is tests/second_tries.yaml. Its lines are added to the repository and removed with the fix of the test. A test
that is in it keeps its first date.
"""

import argparse
import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from datetime import date, datetime, timezone
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]
RECORD = ROOT / "tests" / "second_tries.yaml"
PATIENCE = 14
"""Days that a test may be in the list."""
_HEAD = """\
# Tests that failed and then passed on a second try, with the day (UTC), written by tests/twice.
# Fix the test, or what it tests, and remove its line: after 14 days it fails the build.
"""

Entries = Mapping[str, date]


def read_entries(text: str) -> dict[str, date]:
    """Return the tests of a list and their dates. Raises ValueError for a line that is no test and a date."""
    found = yaml.safe_load(text) or {}
    if not isinstance(found, dict) or any(type(each) is not date for each in found.values()):
        raise ValueError('expected lines as: "tests/test_a.py::test_b": 2026-01-31')
    return {str(name): each for name, each in found.items()}


def write_lines(entries: Entries) -> list[str]:
    """Return a line for each entry, sorted by test."""
    return [f"{json.dumps(name)}: {each}" for name, each in sorted(entries.items())]


def add_tests(entries: Entries, tests: Iterable[str], today: date) -> dict[str, date]:
    """Return the entries with tests that have failed once today."""
    return {**dict.fromkeys(tests, today), **entries}


def find_old(entries: Entries, today: date) -> list[str]:
    """Return a line for each test that has been in the list for PATIENCE days or longer."""
    return [
        f"{name} passed only on a second try {(today - since).days} days ago, on {since}; "
        f"fix the test or what it tests, then remove its line from tests/{RECORD.name}"
        for name, since in sorted(entries.items())
        if (today - since).days >= PATIENCE
    ]


def main(arguments: Sequence[str]) -> int:
    """Print the list, or add to it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--add", type=Path, metavar="FILE", help="tests that passed on a second try; tests/twice adds them"
    )
    options = parser.parse_args(arguments)
    today = datetime.now(timezone.utc).date()
    entries = read_entries(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    if options.add is not None:
        tests = [name for name in json.loads(options.add.read_text(encoding="utf-8")) if "::" in name]
        entries = add_tests(entries, tests, today)
        RECORD.write_text(_HEAD + "".join(f"{line}\n" for line in write_lines(entries)), encoding="utf-8")
        sys.stdout.write(f"== passed only on a second try; lines for tests/{RECORD.name}:\n")
        sys.stdout.write("".join(f"{line}\n" for line in write_lines({name: entries[name] for name in tests})))
        return 0
    sys.stdout.write("".join(f"{line}\n" for line in write_lines(entries)))
    old = find_old(entries, today)
    sys.stdout.write("".join(f"error: {line}\n" for line in old))
    return 1 if old else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
