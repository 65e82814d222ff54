"""Measure the share of missing packages of launch repositories for which `ur get` names a way."""

from __future__ import annotations

import argparse
import os
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

from ur.get.computer import ThisComputer, load_tables
from ur.get.model import GetPlan
from ur.get.plan import make_plan
from ur.get.render import render_plan
from ur.get.targets import folder_needs
from ur.request.environment import add_own_package

SHARE = 0.95
WAYS = ("debian", "pypi", "source", "unknown")
BLANK = (None, "unknown")  # what another repository may know better


def main() -> int:
    """Print a line for each repository and one for all; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--index", action="append", default=[])
    parser.add_argument("--plans", action="store_true", help="print the plan of each repository")
    options = parser.parse_args()
    sources = ThisComputer(os.environ, options.index)
    environment = add_own_package(os.environ)
    repositories = sorted(each for each in options.folder.iterdir() if each.is_dir() and each.name[0] != ".")
    needs = {each.name: folder_needs([str(each)], environment, manifests=False) for each in repositories}
    missing = {each.package: each for need in needs.values() for each in need.missing}
    tables, notes = load_tables(missing.values(), sources)  # one question to apt for all
    whole: dict[str, str] = {}
    print(f"{'repository':30} {'missing':>7} {'debian':>7} {'pypi':>7} {'source':>7} {'unknown':>7}")
    for name, need in needs.items():
        plan = make_plan(need.missing, replace(tables, hints=need.hints, names=frozenset(need.names)), need.is_there)
        whole.update(
            {step.missing.package: step.way for step in plan.steps if whole.get(step.missing.package) in BLANK}
        )
        report(name, plan)
        if options.plans:
            print(render_plan(plan), end="")
    count = Counter(whole.values())
    named = sum(count[way] for way in WAYS[:3])
    share = named / len(whole) if whole else 1.0
    print("\n".join(f"note: {note}" for note in notes) or "note: all tables were there")
    print("not found: " + (", ".join(sorted(name for name, way in whole.items() if way == "unknown")) or "none"))
    print(f"{named} of {len(whole)} packages are named with a way to get them: {share:.1%}")
    return 0 if share >= SHARE else 1


def report(name: str, plan: GetPlan) -> None:
    """Print the line of a repository."""
    counts = "".join(f" {len(plan.steps_by(way)):7}" for way in WAYS)  # type: ignore[arg-type]
    print(f"{name[:30]:30} {len(plan.steps):7}{counts}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
