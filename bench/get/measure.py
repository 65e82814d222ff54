"""Measure the share of missing packages of launch repositories for which `ur get` names a way."""

from __future__ import annotations

import argparse
import os
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ur.get.computer import ThisComputer, load_tables
from ur.get.folder import folder_needs
from ur.get.owners import confirm_guesses
from ur.get.plan import make_plan
from ur.get.render import render_plan
from ur.get.steps import GetPlan, InstallStep
from ur.request.environment import add_own_package

SHARE = 0.95
WAYS = ("debian", "pypi", "source", "here", "unknown")
BLANK = (None, "unknown")  # what another repository may know better


class Computer(ThisComputer):
    """This computer, which can be given the addresses of repositories that exist instead of asking their servers."""

    def __init__(self, indexes: list[str], repositories: Path | None) -> None:
        super().__init__(os.environ, indexes)
        rows = [line.split() for line in repositories.read_text().splitlines()] if repositories else None
        self._repositories = None if rows is None else {row[0]: row[1:] or ["master"] for row in rows if row}

    def list_branches(self, url: str) -> Sequence[str] | None:
        """See Sources."""
        return super().list_branches(url) if self._repositories is None else self._repositories.get(url, ())


def main() -> int:
    """Print a line for each repository and one for all; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--index", action="append", default=[])
    parser.add_argument(
        "--repositories", type=Path, help="addresses that exist, one a line, each with its branches: no server is asked"
    )
    parser.add_argument("--plans", action="store_true", help="print the plan of each repository")
    options = parser.parse_args()
    sources = Computer(options.index, options.repositories)
    environment = add_own_package(os.environ)
    repositories = sorted(each for each in options.folder.iterdir() if each.is_dir() and each.name[0] != ".")
    needs = {each.name: folder_needs([str(each)], environment) for each in repositories}
    missing = {each.package: replace(each, owners=()) for need in needs.values() for each in need.missing}
    tables, notes = load_tables(missing.values(), sources)  # one question to apt for all
    whole: dict[str, str] = {}
    print(f"{'repository':30} {'missing':>7} {'debian':>7} {'pypi':>7} {'source':>7} {'here':>7} {'unknown':>7}")
    for name, need in needs.items():
        tables = replace(tables, hints=need.hints, names=frozenset(need.names), confirmed={})
        unknown = [step.missing for step in make_plan(need.missing, tables, need.is_there).steps_by("unknown")]
        tables = replace(tables, confirmed=confirm_guesses(unknown, sources.list_branches))
        plan = make_plan(need.missing, tables, need.is_there)
        whole.update(
            {step.missing.package: way_of(step) for step in plan.steps if whole.get(step.missing.package) in BLANK}
        )
        report(name, plan)
        if options.plans:
            print(render_plan(plan), end="")
    count = Counter(whole.values())
    named = sum(count[way] for way in WAYS[:-1])
    share = named / len(whole) if whole else 1.0
    print("\n".join(f"note: {note}" for note in notes) or "note: all tables were there")
    print("not found: " + (", ".join(sorted(name for name, way in whole.items() if way == "unknown")) or "none"))
    print(f"{named} of {len(whole)} packages are named with a way to get them: {share:.1%}")
    return 0 if share >= SHARE else 1


def way_of(step: InstallStep) -> str:
    """The way to get a package; "here" where something in the folder is to be changed instead."""
    return "here" if step.here else "debian" if step.way == "other" else step.way


def report(name: str, plan: GetPlan) -> None:
    """Print the line of a repository."""
    ways = Counter(map(way_of, plan.steps))
    counts = "".join(f" {ways[way]:7}" for way in WAYS)
    print(f"{name[:30]:30} {len(plan.steps):7}{counts}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
