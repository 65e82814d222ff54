"""The check of `ur check`, without click, whose import takes a sixth of a check of 40 files."""

from __future__ import annotations

import gc
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ur.source.render import shows_colour

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ur.check.session import CheckReport


def check_files(
    paths: Sequence[str],
    select: Sequence[str] = (),
    ignore: Sequence[str] = (),
    form: str = "human",
    *,
    fix: bool = False,
    strict: bool = False,
    cached: bool = True,
) -> int:
    """Check, print the findings, and return the exit code of `ur check`."""
    from ur.check.cache.store import cache_folder, digest_program, load_recall, name_cache, store_recall
    from ur.check.catalogue import choose_rules, load_rules
    from ur.check.rule import describe_left_out
    from ur.check.session import check_paths
    from ur.check.worlds import make_world
    from ur.request.environment import add_own_package
    from ur.source.arguments import split_argv, values_of
    from ur.source.progress_line import show_progress

    gc.disable()  # nearly all objects are needed until the end
    chosen = choose_rules(select, ignore)
    names, arguments = split_argv(paths)
    places, values = list(names) or ["."], values_of(arguments)
    program = digest_program() if cached else ""
    cache = f"{cache_folder(os.environ)}/{name_cache([*map(os.path.abspath, places), *names], chosen, values)}"

    def check() -> CheckReport:
        recall = load_recall(cache, program) if cached else None
        with show_progress("finding launch files") as progress:
            world = make_world(places, add_own_package(os.environ))
            report = check_paths(places, world, chosen, values, progress, recall)
        if recall is not None:
            store_recall(recall, cache, program)
        return report

    report = check()
    if fix:
        from ur.check.findings.suppress import plan_repairs
        from ur.cli.output import replace_file

        repairs = plan_repairs(report.findings, load_rules())
        for repair in repairs:
            replace_file(repair.path, repair.text, "repaired")
        repaired = sum(len(repair.findings) for repair in repairs)
        sys.stderr.write(f"repaired {repaired} finding{'' if repaired == 1 else 's'} in {len(repairs)} files\n")
        report = check()
    _show(report, form)
    if note := describe_left_out(report.left_out):
        sys.stderr.write(f"{note}\n")
    return 2 if not report.files else 1 if report.errors or (strict and report.findings) else 0


def _show(report: CheckReport, form: str) -> None:
    from ur.check.render.text import render_github, render_json, render_text, shorten_paths

    report = shorten_paths(report, str(Path.cwd()))
    if form == "human":
        sys.stdout.write(render_text(report, colour=shows_colour(sys.stdout)))
    else:
        sys.stdout.write(render_json(report) if form == "json" else render_github(report))
    sys.stdout.flush()
