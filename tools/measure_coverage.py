"""Measure the branch coverage of packages by their own tests, and compare it with what has been recorded.

    .venv/bin/python tools/measure_coverage.py                # exit code 1 when a package is covered less than recorded
    .venv/bin/python tools/measure_coverage.py ur.graph       # the same for some packages
    .venv/bin/python tools/measure_coverage.py --write        # record the figures, in tests/coverage.yaml
    .venv/bin/python tools/measure_coverage.py --missing ur.graph      # print also the lines that no test runs

Coverage counts statements and branches of a package that the tests in its own folder take (ur.graph: tests/graph/),
without those that start ROS. Programs that tests start are not measured, nor are modules that need ROS (`omit` in
pyproject.toml): figures of packages that are mostly tested as programs, as `ur.cli` is, are low.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[1]
RECORD = ROOT / "tests" / "coverage.yaml"
TOLERANCE = 0.3
"""Points that a figure may fall: some tests take other branches each time."""
_NO_TESTS = 5  # pytest's exit code
_HEAD = """\
# Coverage of each package in per cent, statements and branches, by the tests in its folder that start no ROS.
# Written by tools/measure_coverage.py --write.
"""

Report = Mapping[str, Mapping[str, Mapping[str, float]]]


def list_packages() -> list[str]:
    """Return the packages that have a figure: `ur.check`, `ur_nodes.motion`, ..."""
    return sorted(
        f"{top}.{path.parent.name}"
        for top in ("ur", "ur_nodes")
        for path in (ROOT / "src" / top).glob("*/__init__.py")
        if folder_of_tests(f"{top}.{path.parent.name}").is_dir()
    )


def folder_of_tests(package: str) -> Path:
    """Return the folder that holds the tests of a package."""
    return ROOT / "tests" / package.removeprefix("ur.").replace(".", "/")


def summarise(files: Report) -> float:
    """Return the per cent of covered statements and branches in the files of a JSON report of coverage."""
    figures = [file["summary"] for file in files.values()]
    whole = sum(each["num_statements"] + each["num_branches"] for each in figures)
    hit = sum(each["covered_lines"] + each["covered_branches"] for each in figures)
    return round(100.0 * hit / whole, 1) if whole else 100.0


def compare(recorded: Mapping[str, float], measured: Mapping[str, float]) -> list[str]:
    """Return a line for each package that is covered less than recorded."""
    return [
        f"{name} is covered by {figure} %, recorded are {recorded[name]} %"
        for name, figure in measured.items()
        if figure < recorded.get(name, 0.0) - TOLERANCE
    ]


def measure_package(package: str) -> Report | None:
    """Run the tests of a package; the files of coverage's JSON report, None when a test failed."""
    with tempfile.TemporaryDirectory(prefix="ur_coverage_") as folder:
        environment = {**os.environ, "COVERAGE_FILE": f"{folder}/data"}
        coverage = [sys.executable, "-m", "coverage"]
        words = [*coverage, "run", "--source", package, "-m", "pytest", "-p", "no:cacheprovider", "--timeout", "600"]
        words += ["--hypothesis-seed", "0", "-m", "not ros and not long and not hosts", str(folder_of_tests(package))]
        done = subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True)
        if done.returncode not in (0, _NO_TESTS):
            sys.stdout.write(done.stdout)
            return None
        report = Path(folder, "report.json")
        subprocess.run([*coverage, "json", "-q", "-o", str(report)], cwd=ROOT, env=environment, capture_output=True)
        return dict(json.loads(report.read_text(encoding="utf-8"))["files"]) if report.exists() else {}


def main(arguments: Sequence[str]) -> int:
    """Measure, print, and compare or record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("packages", nargs="*", metavar="PACKAGE", help="default: all")
    parser.add_argument("--write", action="store_true", help="record the figures instead of comparing them")
    parser.add_argument("--missing", action="store_true", help="print the lines that no test runs")
    options = parser.parse_args(arguments)
    packages = options.packages or list_packages()
    if unknown := sorted(set(packages) - set(list_packages())):
        sys.stderr.write(f"error: no package {unknown[0]!r} with tests, expected one of {', '.join(list_packages())}\n")
        return 2
    recorded: dict[str, float] = yaml.safe_load(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    measured: dict[str, float] = {}
    with ThreadPoolExecutor(min(8, (os.cpu_count() or 1) + 1)) as pool:
        for name, files in zip(packages, pool.map(measure_package, packages), strict=True):
            if files is None:
                sys.stdout.write(f"error: tests of {name} failed, so it has no figure\n")
                continue
            measured[name] = summarise(files)
            sys.stdout.write(f"{name:24} {measured[name]:5.1f} %  recorded: {recorded.get(name, 'nothing')}\n")
            for path, file in files.items() if options.missing else ():
                if file["missing_lines"]:
                    sys.stdout.write(f"  {path}: {', '.join(map(str, file['missing_lines']))}\n")
            sys.stdout.flush()
            if options.write:
                recorded[name] = measured[name]
                RECORD.write_text(_HEAD + yaml.safe_dump(recorded, sort_keys=True), encoding="utf-8")
    worse = compare(recorded, measured)
    sys.stdout.write("".join(f"error: {line}\n" for line in worse))
    if worse:
        sys.stdout.write("  help: add tests; where code has moved: tools/measure_coverage.py --write, and say why\n")
    return 1 if worse or len(measured) < len(packages) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
