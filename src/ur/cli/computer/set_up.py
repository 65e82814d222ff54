"""`ur setup`: set up this computer as a viewer."""

import getpass
import os
import sys
from importlib.util import find_spec

import click

from ur.cli.changing import ChangeReporter, show_changes
from ur.complete.verbs import SCRIPTS
from ur.mcp import PACKAGES
from ur.request.requirements.python_packages import need_all
from ur.robot.setup.change import Change
from ur.robot.setup.engine import apply_change, apply_states, gather, gather_facts, plan_changes, plan_undo
from ur.robot.setup.facts import ComputerFacts
from ur.robot.setup.viewer_states import base_request, wanted_here
from ur.robot.setup.wanted import Wanted
from ur.robot.ssh.shell import LocalShell
from ur.source.diagnostic import user_error
from ur.source.progress_line import show_progress
from ur.source.project import project_folder, state_folder
from ur.system.debian_root import MARK


@click.group("setup", invoke_without_command=True)
@click.option("--dry-run", is_flag=True, help="Show what would be changed, and change nothing.")
@click.option("--undo", is_flag=True, help="Undo what this command wrote; packages, keys and groups are kept.")
@click.option("--only-mine", is_flag=True, help="Change only what needs no root: your shells, keys and workspace.")
@click.option("--yes", is_flag=True, help="Do not ask before changing.")
@click.pass_context
def command(context: click.Context, dry_run: bool, undo: bool, only_mine: bool, yes: bool) -> int:
    """Set this computer up: shells, keys, workspace, names.

    Shows every difference before it changes anything. Your own lines are kept. A second run changes nothing.
    """
    if context.invoked_subcommand is not None:
        return 0
    user = getpass.getuser()
    shell = LocalShell(terminal=sys.stdin.isatty())
    base = base_request(user)

    def want(facts: ComputerFacts) -> list[Wanted]:
        return wanted_here(facts, state_folder(), system=not only_mine, completion=SCRIPTS)

    with show_progress("examining this computer"):
        items = want(gather(shell, base))
        facts = gather_facts(shell, items, user, base, root=False)
    changes = plan_undo(items, facts) if undo else plan_changes(items, facts)
    assistants = not undo and not all(map(find_spec, PACKAGES[0]))
    if not changes and not assistants:
        click.echo("nothing to take back" if undo else "nothing to do: this computer is set up")
        return 0
    show_changes(changes)
    if assistants:
        click.echo(f"Python packages: {PACKAGES[2]}")
    if dry_run:
        return 0
    question = f"{len(changes) + assistants} changes: make them?"
    if not yes and sys.stdin.isatty() and not click.confirm(question, default=True):
        click.echo("nothing was changed")
        return 1
    if undo:
        for change in changes:
            click.echo(f"  {change.title} ...")
            apply_change(shell, change)
        click.echo("reverted; open a new terminal")
    else:
        reporter = ChangeReporter("", live=sys.stdout.isatty())

        def report(change: Change) -> None:
            reporter(f"  {change.title} ...")

        apply_states(shell, want, user, base, root=False, report=report, progress=reporter.show_progress)
        need_all(*PACKAGES)
        reporter("this computer is set up; open a new terminal to use it")
    return 0


@command.command("debian", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@click.argument("action", type=click.Choice(["status", "shell", "install", "update", "remove"]), default="status")
@click.argument("argv", nargs=-1, type=click.UNPROCESSED, metavar="[ARGUMENT ...]")
def debian(action: str, argv: tuple[str, ...]) -> None:
    """Inspect, change or remove the Debian root that ROS runs in.

    On a release without ROS 1, `ur use sim --ros 1` makes it. Commands of ur and programs of ROS run in it
    automatically. sudo may ask for your password. An update also allows bwrap to make user namespaces where AppArmor
    refuses them.
    """
    if action == "install" and not argv:
        raise click.UsageError("missing argument 'PACKAGE'")
    if action in ("status", "update", "remove") and argv:
        raise click.UsageError(f"got unexpected extra argument ({argv[0]})")
    if action in ("install", "update", "remove") and os.path.exists(MARK):  # noqa: PTH110 - as in ur.system.debian_root
        raise user_error(
            f"'ur setup debian {action}' cannot run inside the Debian root, expected a shell of this computer",
            rule="inside-root",
            help=f"in another terminal: {project_folder()}/ur setup debian {' '.join((action, *argv))}",
            subject=action,
        )
    script = str(project_folder() / "tools" / "debian_root.bash")
    os.execv("/bin/bash", ["bash", script, action, *argv])  # noqa: S606 - the script takes the place of this process
