"""Measure the share of missing packages of launch repositories for which `ur get` names a way."""

from __future__ import annotations

import argparse
import os
import sys
from collections import Counter
from pathlib import Path

from ur.get.computer import ThisComputer, load_tables
from ur.get.model import GetPlan
from ur.get.plan import make_plan
from ur.get.targets import folder_needs
from ur.request.environment import add_own_package

SHARE = 0.95
WAYS = ("debian", "pypi", "source", "unknown")


def main() -> int:
    """Print a line for each repository and one for all; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--index", action="append", default=[])
    options = parser.parse_args()
    sources = ThisComputer(os.environ, options.index)
    environment = add_own_package(os.environ)
    repositories = sorted(each for each in options.folder.iterdir() if each.is_dir() and each.name[0] != ".")
    whole: dict[str, str] = {}
    notes: set[str] = set()
    print(f"{'repository':30} {'missing':>7} {'debian':>7} {'pypi':>7} {'source':>7} {'unknown':>7}")
    for repository in repositories:
        needs = folder_needs([str(repository)], environment, manifests=False)
        tables, found = load_tables(needs.missing, sources)
        plan = make_plan(needs.missing, tables, needs.is_there)
        notes.update(found)
        whole.update({step.missing.package: step.way for step in plan.steps})
        report(repository.name, plan)
    count = Counter(whole.values())
    named = sum(count[way] for way in WAYS[:3])
    share = named / len(whole) if whole else 1.0
    print("\n".join(f"note: {note}" for note in sorted(notes)) or "note: all tables were there")
    print("not found: " + (", ".join(sorted(name for name, way in whole.items() if way == "unknown")) or "none"))
    print(f"{named} of {len(whole)} packages are named with a way to get them: {share:.1%}")
    return 0 if share >= SHARE else 1


def report(name: str, plan: GetPlan) -> None:
    """Print the line of a repository."""
    counts = "".join(f" {len(plan.steps_by(way)):7}" for way in WAYS)  # type: ignore[arg-type]
    print(f"{name[:30]:30} {len(plan.steps):7}{counts}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
