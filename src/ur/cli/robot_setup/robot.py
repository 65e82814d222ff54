"""`ur robot setup`: set up freshly flashed robots."""

import getpass
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import click

from ur.cli.changing import ChangeReporter, show_changes
from ur.cli.output import plain_text
from ur.cli.robot_setup.calibrate import calibrate
from ur.cli.robot_setup.contact import confirm_host_key, decide_robot_login, read_fingerprint
from ur.cli.robot_setup.network import network, wifi
from ur.cli.robot_setup.questions import PLAIN, ask_task, check_names, list_known_tasks, read_passwords, read_tasks
from ur.cli.robot_setup.rename import rename
from ur.cli.robots.fleet import ALL, run_for_each
from ur.devices.needs import examine
from ur.request.environment import current_selection
from ur.request.programs import PACKAGE
from ur.robot.base import load_base
from ur.robot.deploy.repository import read_programs, read_repository
from ur.robot.devices import expected_devices, inspect_devices
from ur.robot.robot_file import ROBOT_FILE
from ur.robot.selection import Selection, selection_path, store_selection
from ur.robot.setup.login import Task, open_robot
from ur.robot.setup.raspberry_pi.header import undo_header
from ur.robot.setup.robot import prepare_viewer, preview, set_up, undo_ros2
from ur.robot.setup.robot_states import ViewerFacts
from ur.robot.setup.ros2.mux_between import give_back, take_over
from ur.robot.setup.ros2.states import find_robot_ros2
from ur.robot.setup.verify import Check, verify
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell
from ur.source.diagnostic import UserError, user_error
from ur.source.render import render_human, shows_colour

MASTER_SECONDS = 60.0


@click.group("robot", invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """Set robots up and change them, over the network."""
    if context.invoked_subcommand is None:
        from ur.cli.help import show_help

        show_help(["robot"])


@command.command("setup")
@click.argument("hosts", nargs=-1, metavar="[HOST | USER@HOST] ...")
@ALL
@click.option("--name", help="Its new name; it will answer to NAME.local. With one HOST only.")
@click.option("--base", help="The base of the robot.")
@click.option("--variant", default=None, help="The variant of the base; 'plain' for none.")
@click.option("--from", "file", type=click.Path(dir_okay=False), help="A YAML file with robots and their settings.")
@click.option(
    "--passwords-from",
    type=int,
    metavar="FD",
    help="Read the present password and the new one, a line each, from this file descriptor.",
)
@click.option(
    "--master/--no-master",
    default=True,
    help="Keep a ROS master running from the robot's boot on, or leave that unchanged. [default: --master]",
)
@click.option(
    "--programs/--no-programs",
    default=True,
    help="Install everything that programs of this project need there, or leave that unchanged. [default: --programs]",
)
@click.option(
    "--access-point/--no-access-point",
    default=None,
    help="Have the robot open a WiFi network of its own while none that it knows is in reach, or never. "
    "[default: as it is, else --access-point]",
)
@click.option("--dry-run", is_flag=True, help="Show what would be changed on the robots, and change nothing there.")
@click.option("--host-key", metavar="SHA256:...", help="The fingerprint of its host key, with one HOST: no question.")
@click.option("--yes", is_flag=True, help="Accept an unknown host key without a question, in a network that you trust.")
@click.option("--new-host-key", is_flag=True, help="Ask about a new host key, because the robot was flashed again.")
@click.option(
    "--take-over",
    "between",
    is_flag=True,
    help="On a robot with ROS 2: have the mux take over the base's velocity topic from its boot on.",
)
@click.option("--undo", is_flag=True, help="Undo what was written with ROS 2, or a Raspberry Pi's header with ROS 1.")
@click.option("--one-of-several", is_flag=True, hidden=True, help="Started by the set-up of several robots.")
@click.option(
    "--robot-login/--no-robot-login",
    default=None,
    help="Let the robot log in to this computer by key, for nodes that roslaunch starts there. [default: ask, else no]",
)
def setup(
    hosts: tuple[str, ...],
    every: bool,
    name: str | None,
    base: str | None,
    variant: str | None,
    file: str | None,
    passwords_from: int | None,
    master: bool,
    programs: bool,
    access_point: bool | None,
    dry_run: bool,
    host_key: str | None,
    yes: bool,
    new_host_key: bool,
    between: bool,
    undo: bool,
    one_of_several: bool,
    robot_login: bool | None,
) -> int:
    """Make freshly flashed robots ready: name, keys, packages, ROS, time, announcement, and this project.

    Asks for what it needs to know. Before any password is sent, it shows the fingerprint of a host key that this
    computer does not know, and asks; without a terminal, it then needs --host-key or --yes.

    Inspects first and changes only what is missing; after an interruption, a second run finishes the set-up. A robot
    without internet fetches its packages over this computer's connection. At the end it checks the connection from both
    ends and prints the result; the robot is then ready to run programs. A single robot is selected (`ur use`), unless
    another one is.

    --take-over changes the unit of a driver of others. --undo reverts that; with ROS 1, a Raspberry Pi's header alone.

    FILE is YAML: `robots:`, a list of mappings with `host`, `name`, `base` and, if wanted, `user`, `variant`,
    `host_key: SHA256:...`, `master: false` and `programs: false`.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    _check_robots(hosts, file, every=every, described=bool(name or base or variant), name=name, host_key=host_key)
    fingerprints: Mapping[str, str] = {}
    tasks = list_known_tasks() if every else [ask_task(host, name, base, variant) for host in hosts]
    if file:
        tasks, fingerprints = read_tasks(Path(file))
    if host_key:
        fingerprints = {tasks[0].robot.name: read_fingerprint(host_key)}
    check_names(tasks)
    viewer = prepare_viewer(here := LocalShell(), getpass.getuser())
    met, refused = _meet(tasks, fingerprints, yes=yes, new_host_key=new_host_key)
    if not met:
        return refused
    met = [replace(each, robot=replace(each.robot, access_point=access_point)) for each in met]
    tasks = met if dry_run or undo else decide_robot_login(met, robot_login)
    current, new = read_passwords(tasks, passwords_from, dry_run=dry_run)
    if len(tasks) > 1 and not dry_run and not undo:
        given = Secret("\n".join(each.reveal() if each else "" for each in (current, new)))
        make = partial(make_argv, master=master, programs=programs, new_host_key=new_host_key, between=between)
        return max(refused, set_up_each(tasks, make, given))
    tasks = [replace(task, current=current, new=new) for task in _equip(tasks, master=master, programs=programs)]
    work = partial(revert_ros2 if undo else _preview, viewer=viewer)
    if not undo and not dry_run:
        work = partial(_set_up, here=here, viewer=viewer, alone=not one_of_several, between=between)
    return max(refused, *(_guard(task, work) for task in tasks))


def _meet(
    tasks: Iterable[Task], fingerprints: Mapping[str, str], *, yes: bool, new_host_key: bool
) -> tuple[list[Task], int]:
    """Return the tasks whose robots have a known or confirmed host key, and an exit code for the others."""
    met: list[Task] = []

    def meet(task: Task) -> int:
        wanted = fingerprints.get(task.robot.name, "")
        met.append(confirm_host_key(task, fingerprint=wanted, yes=yes, new_host_key=new_host_key))
        return 0

    # One after the other: there is only one terminal for questions. A refused robot does not stop the others.
    refused = max(_guard(task, meet) for task in tasks)
    return met, refused


def _equip(tasks: Iterable[Task], *, master: bool, programs: bool) -> list[Task]:
    """Return the tasks with the files for their robots, and the devices of their bases."""
    library, environment = read_repository(), read_programs()
    return [
        replace(
            task,
            robot=replace(task.robot, master=task.robot.master and master, programs=task.robot.programs and programs),
            library=(library, environment) if task.robot.programs and programs else (library,),
            devices=expected_devices(load_base(PACKAGE, task.robot.base, task.robot.variant)),
        )
        for task in tasks
    ]


def _check_robots(
    hosts: Sequence[str], file: str | None, *, every: bool, described: bool, name: str | None, host_key: str | None
) -> None:
    """Raise UsageError for options that exclude each other. `described`: name, base or variant is given."""
    if every and (hosts or file or described):
        message = "--all sets up every robot as it was: expected no HOST, --name, --base, --variant or --from beside it"
        raise click.UsageError(message)
    if file and (hosts or described):
        raise click.UsageError("--from FILE names the robots: expected no HOST, --name, --base or --variant beside it")
    if not file and not hosts and not every:
        raise click.UsageError("missing argument 'HOST', for instance ros@robot.local")
    if name and len(hosts) > 1:
        raise click.UsageError("--name is for one HOST, expected --from FILE for several")
    if host_key and (file or every or len(hosts) > 1):
        raise click.UsageError("--host-key is for one HOST, expected host_key in --from FILE for several")


def _set_up(task: Task, here: LocalShell, viewer: ViewerFacts, *, alone: bool, between: bool) -> int:
    report = ChangeReporter(task.robot.name if alone else "", live=alone and sys.stdout.isatty())
    task = find_ros2(task, report)
    count = set_up(task, here, viewer, report, report.show_progress)
    if between:
        task, more = put_mux_between(task, report)
        count += more
    # Verified through the new name, by key, with strict host keys: as it will be used.
    with open_robot(replace(task, address=task.later, host_key=None, first_contact=False), report) as there:
        checks = verify(task, here, there, viewer, wait_for_master)
        needs = [need for need in examine(inspect_devices(there), task.devices) if need.state != "ready"]
    _print_checks(task, checks)
    for need in needs:
        report(f"note: {need.message}\n  help: {need.help}")
    bad = sum(not check.good for check in checks)
    if bad:
        report(f"{bad} of {len(checks)} points are not as they should be; 'ur doctor {task.robot.name}' says more")
        return 1
    changes = "1 change" if count == 1 else f"{count} changes"
    chosen = alone and select_robot(task)
    use = "it is selected" if chosen else f"select it: ur use {task.robot.name}"
    report(f"ready after {changes}; {use}" if count else "nothing to do: it is ready")
    return 0


def select_robot(task: Task) -> bool:
    """Select a robot that was set up, unless the user has selected another one; return whether it is selected."""
    path = selection_path(os.environ)
    try:
        selected = current_selection(os.environ)
    except UserError:
        return False
    if selected.robot == task.robot.name:
        return True
    former = task.address.host.removesuffix(".local")
    if path.exists() and not selected.simulated and selected.robot != former:
        return False
    store_selection(path, Selection(task.robot.name, ""))
    return True


def wait_for_master(host: str) -> bool:
    """Return whether the ROS master of a robot answers; wait for it as long as a boot takes."""
    from ur.request.remote.connection import list_node_names

    end = time.monotonic() + MASTER_SECONDS
    while time.monotonic() < end:
        if list_node_names(host, 2.0) is not None:
            return True
        time.sleep(0.2)
    return False


def _preview(task: Task, viewer: ViewerFacts) -> int:
    task = find_ros2(task, ChangeReporter(task.robot.name))
    with open_robot(task, ChangeReporter(task.robot.name)) as shell:
        changes = preview(task, shell, viewer)
    click.echo(f"{task.robot.name} ({task.address}): " + ("" if changes else "nothing to do"))
    show_changes(changes)
    return 0


def _guard(task: Task, work: Callable[[Task], int]) -> int:
    """Run one task and return its exit code; print a UserError and return 2."""
    try:
        return work(task)
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics, colour=shows_colour(sys.stderr)))
        return 2


def _print_checks(task: Task, checks: Sequence[Check]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(title=plain_text(task.robot.name), title_justify="left")
    for column in ("", "point", "seen from", "what"):
        table.add_column(column)
    for check in checks:
        mark = "[green]ok[/]" if check.good else "[red]NO[/]"
        table.add_row(mark, *map(plain_text, (check.title, check.place, check.seen)))
    Console(soft_wrap=not sys.stdout.isatty()).print(table)


for _change in (rename, wifi, network, calibrate):
    command.add_command(_change)


def find_ros2(task: Task, report: ChangeReporter) -> Task:
    """Return the task with the robot's ROS 2, which stays unchanged.

    If this first login had to change the password, the robot has the new one, and later logins may use it.
    """
    with open_robot(task, report) as shell:
        found = find_robot_ros2(shell)
        if task.new in shell.accepted:
            task = replace(task, first_contact=False)
    if found is None:
        return task
    ros2, topics = found
    where = f"domain {ros2.domain}" + (f", {ros2.middleware}" if ros2.middleware else "")
    kind = topics.get(ros2.commands, "").rpartition("/")[2]
    commands = f"{ros2.commands}, {kind}" if kind else ros2.commands
    report(f"ROS 2 {ros2.distro.capitalize()} ({where}; commands: {commands}), which stays as it is")
    others = [f"{name} ({kind.rpartition('/')[2]})" for name, kind in topics.items() if name != ros2.commands]
    if others:
        report(f"the base takes {', '.join(others)}, too; ros_commands in {ROBOT_FILE} names the one that is used")
    return replace(task, robot=replace(task.robot, ros2=ros2, master=False), devices=())


def put_mux_between(task: Task, report: ChangeReporter) -> tuple[Task, int]:
    """Install the mux before the base of a robot with ROS 2; return the task and the number of changes.

    The task has the base's topic. Raises UserError if the robot has no ROS 2, or its driver did not subscribe to the
    other topic.
    """
    if task.robot.ros2 is None:
        message = f"{task.robot.name} has no ROS 2, expected a robot with ROS 2 and --take-over"
        raise user_error(message, rule="usage", help="leave --take-over out")
    with open_robot(replace(task, address=task.later, host_key=None, first_contact=False), report) as shell:
        robot, count = take_over(shell, task.robot, report)
    return replace(task, robot=robot), count


def revert_ros2(task: Task, viewer: ViewerFacts) -> int:
    """Revert the set-up; return the exit code.

    With ROS 1 it reverts the header of a Raspberry Pi alone. Raises UserError if that was not changed either.
    """
    report = ChangeReporter(task.robot.name)
    task = find_ros2(task, report)
    if task.robot.ros2 is None:
        with open_robot(task, report) as shell:
            count = undo_header(shell, task.address.user, report)
        if count:
            report("the rest of the set-up stays: docs/how-to/uninstall.md has the steps")
            return 0
        message = f"{task.robot.name} has no ROS 2, or ROS 1 as well, expected a robot with ROS 2 alone"
        raise user_error(message, rule="usage", help="docs/how-to/uninstall.md has the steps")
    with open_robot(task, report) as shell:
        count = give_back(shell, report)
    count += undo_ros2(task, viewer, report)
    report(f"{count} changes taken back; packages stay" if count else "nothing to take back")
    return 0


def set_up_each(tasks: Sequence[Task], make: Callable[[Task], list[str]], passwords: Secret) -> int:
    """Set up several robots; return the highest exit code.

    `make` returns the arguments of `ur` for one of them. `passwords` are the present and the new one, a line each,
    which go to the standard input of each process. Raises KeyboardInterrupt after all of them were ended.
    """
    by_name = {task.robot.name: task for task in tasks}
    try:
        return run_for_each(
            "robot setup", tuple(by_name), lambda name: make(by_name[name]), passwords=dict.fromkeys(by_name, passwords)
        )
    except KeyboardInterrupt:
        sys.stderr.write("interrupted; the same command continues where it stopped\n")
        raise


def make_argv(task: Task, *, master: bool, programs: bool, new_host_key: bool, between: bool = False) -> list[str]:
    """Return the arguments of `ur` that set up this robot alone, with all answers for it.

    A host key that the user has confirmed is given by its fingerprint: the process accepts no other one.
    """
    robot = task.robot
    argv = ["robot", "setup", str(task.address), "--one-of-several", "--passwords-from", "0"]
    argv += ["--name", robot.name, "--base", robot.base, "--variant", robot.variant or PLAIN]
    argv += ["--host-key", task.host_key.fingerprint] if task.host_key else []
    argv += ["--robot-login" if task.robot_login else "--no-robot-login"]
    unwanted = (
        ("--no-master", not (master and robot.master)),
        ("--no-programs", not (programs and robot.programs)),
        ("--new-host-key", new_host_key),
        ("--take-over", between),
        ("--access-point", robot.access_point is True),
        ("--no-access-point", robot.access_point is False),
    )
    return argv + [option for option, given in unwanted if given]
