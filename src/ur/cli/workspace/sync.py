"""`ur sync`: synchronise the workspaces of this computer and a robot."""

import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import click

from ur.cli.robots.fleet import ALL, choose_robots, is_fleet, run_for_each
from ur.cli.workspace.mount import read_mounts
from ur.fleet.processes import answer_confirmed
from ur.request.remote.connection import connect_robot, robot_address
from ur.robot.sync.compare import compare, describe_plan, summarise
from ur.robot.sync.steps import SIDES, Side, SyncPlan, load_memory, memory_path, store_memory
from ur.robot.sync.sync import (
    WORKSPACE,
    SyncOutcome,
    carry_out,
    check_paths,
    list_workspaces,
    lock_sync,
    name_this_computer,
    refuse_sync,
    workspace_path,
)
from ur.source.printable import printable
from ur.source.progress_line import show_progress


@click.command("sync")
@click.argument("robot", required=False)
@click.argument("paths", nargs=-1, metavar="[PATH ...]")
@ALL
@click.option("--to", "only_to", is_flag=True, help="Copy only from this computer to the robot.")
@click.option("--from", "only_from", is_flag=True, help="Copy only from the robot to this computer.")
@click.option(
    "--take", "prefer", type=click.Choice(SIDES), help="Decide conflicts of the PATHs: the file here, or the one there."
)
@click.option("--dry-run", is_flag=True, help="Show the plan, and change nothing.")
@click.option("--yes", is_flag=True, help="Do not ask before changing.")
@click.option(
    "--agree-through", type=int, hidden=True, help="The socket to the `ur sync` that asks for several robots."
)
def command(
    robot: str | None,
    paths: tuple[str, ...],
    every: bool,
    only_to: bool,
    only_from: bool,
    prefer: Side | None,
    dry_run: bool,
    yes: bool,
    agree_through: int | None,
) -> int:
    """Synchronise the workspaces of this computer and robots.

    Synchronises ~/catkin_ws/src of both computers, in both directions. Shows its plan and asks. A file that was changed
    on both sides since the last sync is a conflict: it is reported and left unchanged on both, until --take chooses for
    its PATH which one is used; the other one is kept. A deletion is copied only if the other side has not changed the
    file. Not copied: .git, build, devel, __pycache__, and what .ursyncignore in the workspace names.

    With --all, every word is a PATH. The plans of several robots are shown first, then one question is asked. Changes
    of one robot reach the others with the next sync.
    """
    if every and robot is not None:
        paths, robot = (robot, *paths), None
    _check_options(paths, prefer, both=only_to and only_from)
    chosen = choose_robots([robot] if robot else [], every=every)
    if is_fleet(chosen, every=every):
        flags = (("--to", only_to), ("--from", only_from), ("--dry-run", dry_run))
        options = [name for name, given in flags if given] + (["--take", prefer] if prefer else [])
        return _sync_each(chosen, paths, options, dry_run=dry_run, yes=yes)
    address = robot_address(chosen[0] if chosen else None)
    name = address.host.removesuffix(".local")
    root = Path.home() / WORKSPACE
    _check_mounts(root)
    only = [workspace_path(path, root) for path in paths]
    memory_file = memory_path(name, os.environ)
    with lock_sync(memory_file), connect_robot(address) as shell:
        with show_progress(f"listing the workspaces here and on {name}"):
            both = list_workspaces(shell, root, load_memory(memory_file))
        agreed = both.last.agreed if both.last else {}
        check_paths(dict(zip(paths, only, strict=True)), {*both.here.files, *both.there.files, *agreed}, root, name)
        sides: Sequence[Side] = ["there"] if only_to else ["here"] if only_from else SIDES
        plan = compare(both.here, both.there, agreed, to=sides, prefer=prefer, only=only if "" not in only else [])
        click.echo("\n".join(map(printable, [*describe_plan(plan, name), summarise(plan, name)])))
        if dry_run:
            return 1 if plan.conflicts else 0
        if plan.steps and not yes and not _agree(agree_through):
            return 1
        outcome = carry_out(
            plan,
            both.pair,
            shell,
            name=name_this_computer(name),
            stamp=time.strftime("%Y-%m-%d-%H%M%S"),
            progress=sys.stdout.isatty(),
            report=click.echo,
        )
        store_memory(memory_file, outcome.memory)
    return _finish(plan, outcome)


def _check_options(paths: Sequence[str], prefer: Side | None, *, both: bool) -> None:
    if both:
        raise click.UsageError("--to and --from cannot be used together; without them both directions are synced")
    if prefer and not paths:
        raise click.UsageError("--take is for the conflicts of PATHs, expected at least one ('.' is everything)")


def _finish(plan: SyncPlan, outcome: SyncOutcome) -> int:
    left = {path: why for side in SIDES for path, why in outcome.left[side].items()}
    for path, why in sorted(left.items()):
        click.echo(f"warning: {printable(path)}: {printable(why)}: left as it is; run this again")
    if any(step.keep for step in plan.steps):
        click.echo("what --take replaced is kept in ~/catkin_ws/.ur_sync/kept")
    if plan.steps:
        click.echo(f"done: {len(plan.steps) - len(left)} of {len(plan.steps)} changes")
    return 1 if left or plan.conflicts else 0


def _sync_each(robots: Sequence[str], paths: Sequence[str], options: Sequence[str], *, dry_run: bool, yes: bool) -> int:
    def make_argv(robot: str) -> list[str]:
        through = [] if dry_run else ["--agree-through", "0"]
        return ["sync", *options, *through, "--", robot, *paths]

    return run_for_each(
        "sync",
        robots,
        make_argv,
        show="all" if dry_run else "failed",
        question="" if dry_run else "make the changes of all robots?",
        confirmed=yes,
    )


def _agree(through: int | None) -> bool:
    if through is not None:
        agreed = answer_confirmed(through)
        if not agreed:
            click.echo("nothing was changed")
        return agreed
    if not sys.stdin.isatty():
        raise refuse_sync("there is no terminal to ask on, so nothing was changed", "--yes makes these changes")
    if click.confirm("make these changes?", default=True):
        return True
    click.echo("nothing was changed")
    return False


def _check_mounts(root: Path) -> None:
    for mount in read_mounts():
        if root.resolve().is_relative_to(mount.target):
            whose = mount.source.partition(":")[0]
            raise refuse_sync(
                f"{mount.target} is a mounted folder of {whose}, expected files of this computer",
                "ur mount ROBOT --undo",
            )
