"""Compare the branch coverage of each package with what has been recorded. It may not fall.

    UR_COVERAGE=.cache/coverage ./test                          # measure: any tests, here the default suite
    .venv/bin/python tools/measure_coverage.py                  # exit code 1 when a package is covered less than before
    .venv/bin/python tools/measure_coverage.py --write          # raise the record, in tests/coverage.yaml
    .venv/bin/python tools/measure_coverage.py --missing ur.graph # print the lines and branches that no test takes

Only what runs in the processes of pytest is measured, and so no node that a test starts: a `*_node.py` counts as not
covered unless a test imports it.
"""

import argparse
import json
import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]
DATA = ROOT / ".cache" / "coverage"
RECORD = ROOT / "tests" / "coverage.yaml"
TOLERANCE = 1.0
"""Points that a figure may fall: some tests take other branches each time, those of ur.fleet 0.9 points of them."""
_HEAD = """\
# Coverage of each package in per cent, statements and branches, by the default suite (Python 3.11).
# Raised by tools/measure_coverage.py --write.
"""

Report = Mapping[str, Mapping[str, Mapping[str, float]]]


def package_of(path: str) -> str:
    """Return the package that a file below src counts for: `ur.check`, `ur_nodes.motion`, ...; `ur` for `ur/x.py`."""
    parts = Path(path).parts
    names = parts[parts.index("src") + 1 :]
    return ".".join(names[: min(2, len(names) - 1)])


def group_by_package(files: Report) -> dict[str, Report]:
    """Return the files of a report of coverage for each package, sorted by package."""
    groups: dict[str, dict[str, Mapping[str, Mapping[str, float]]]] = defaultdict(dict)
    for path, file in files.items():
        groups[package_of(path)][path] = file
    return dict(sorted(groups.items()))


def summarise(files: Report) -> float:
    """Return the per cent of covered statements and branches in the files of a report of coverage."""
    figures = [file["summary"] for file in files.values()]
    hit = sum(each["covered_lines"] + each["covered_branches"] for each in figures)
    whole = hit + sum(each["missing_lines"] + each["missing_branches"] for each in figures)
    return round(100.0 * hit / whole, 1) if whole else 100.0


def compare(recorded: Mapping[str, float], measured: Mapping[str, float]) -> list[str]:
    """Return a line for each package that is covered less than recorded."""
    return [
        f"{name} is covered by {figure} %, expected at least {recorded[name]} %; the lines that no test runs: "
        f".venv/bin/python tools/measure_coverage.py --missing {name}"
        for name, figure in measured.items()
        if figure < round(recorded.get(name, 0.0) - TOLERANCE, 1)
    ]


def raise_record(recorded: Mapping[str, float], measured: Mapping[str, float]) -> dict[str, float]:
    """Return the higher figure of each package that there is."""
    return {name: max(figure, recorded.get(name, 0.0)) for name, figure in measured.items()}


def read_report(data: Path) -> Report:
    """Return the files of the coverage of all processes that wrote into a folder."""
    import slipcover  # which Python 3.10 and 3.11 do not have on arm64: `main` says so

    first, *others = (json.loads(path.read_text(encoding="utf-8")) for path in sorted(data.glob("*.json")))
    for each in others:
        slipcover.merge_coverage(first, each)
    return dict(first["files"])


def main(arguments: Sequence[str]) -> int:
    """Print, and compare or record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="raise the record to the figures that are higher")
    parser.add_argument("--missing", metavar="PACKAGE", help="print the lines and branches that no test takes")
    options = parser.parse_args(arguments)
    if find_spec("slipcover") is None:
        sys.stderr.write("error: slipcover is not installed, so coverage cannot be compared\n")
        sys.stderr.write("  help: bash tools/set_up.bash test (on arm64 with Python 3.12 or later)\n")
        return 2
    if not any(DATA.glob("*.json")):
        sys.stderr.write("error: nothing was measured, expected data in .cache/coverage\n")
        sys.stderr.write("  help: UR_COVERAGE=.cache/coverage ./test\n")
        return 2
    packages = group_by_package(read_report(DATA))
    if options.missing:
        for path, file in packages.get(options.missing, {}).items():
            lines = [*file["missing_lines"], *("->".join(map(str, each)) for each in file["missing_branches"])]
            sys.stdout.write(f"{path}: {', '.join(map(str, lines))}\n" if lines else "")
        return 0
    measured = {name: summarise(files) for name, files in packages.items()}
    recorded: dict[str, float] = yaml.safe_load(RECORD.read_text(encoding="utf-8"))
    if options.write:
        recorded = raise_record(recorded, measured)
        RECORD.write_text(_HEAD + yaml.safe_dump(recorded, sort_keys=True), encoding="utf-8")
    for name, figure in measured.items():
        sys.stdout.write(f"{name:24} {figure:5.1f} %  recorded: {recorded.get(name, 'nothing')}\n")
    worse = compare(recorded, measured)
    sys.stdout.write("".join(f"error: {line}\n" for line in worse))
    if worse:
        sys.stdout.write("  help: add tests; where covered code was removed, lower the line in tests/coverage.yaml\n")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
