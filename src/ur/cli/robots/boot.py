"""`ur boot`: services that a robot starts when it boots."""

import os
import sys
from collections.abc import Sequence

import click

from ur.cli.changing import PASSWORD_FROM, become_root, show_changes
from ur.cli.output import read_lines
from ur.cli.robots.fleet import ALL, ask_passwords, choose_robots, is_fleet, run_for_each
from ur.request.remote.boot_command import PAGE, check_name, has_service, install_services, remove_services
from ur.request.remote.connection import connect_robot, robot_address
from ur.request.requirements.python_packages import need_all
from ur.robot.boot.units import MASTER, SCRIPT, describe_status, parse_status
from ur.robot.ssh.openssh import SshShell
from ur.source.ansi import allows_colour
from ur.source.diagnostic import UserError, user_error

_robot = click.option("--robot", help="Which robot. [default: the selected one]")
_robots = click.option(
    "--robot", "robots", multiple=True, help="Which robot; may be repeated. [default: the selected one]"
)


@click.group("boot", invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """Choose what a robot starts when it boots."""
    if context.invoked_subcommand is None:
        from ur.cli.help import show_help

        show_help(["boot"])


@command.command("install", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@_robots
@ALL
@click.option("--name", help="The name of the service. [default: that of the launch file or program]")
@PASSWORD_FROM
@click.argument(
    "argv", nargs=-1, type=click.UNPROCESSED, metavar="[PACKAGE FILE.launch | PROGRAM | web | COMMAND] [ARG:=VALUE ...]"
)
def install(
    robots: tuple[str, ...], every: bool, name: str | None, password_from: int | None, argv: tuple[str, ...]
) -> int:
    """Start a ROS master when the robot boots, and a launch file, program or command after it; `web` is its page.

    Both wait for the robot's address; a service that ends is restarted, after pauses that grow if it keeps ending. The
    launch file has to be on the robot: `ur sync` copies it. Its arguments get the robot's base and variant, and that
    nothing is simulated. All services run as the robot's user, with the environment of that user's login shell; on a
    robot with ROS 2, without a master, in the domain and namespace of its nodes.
    """
    chosen = choose_robots(robots, every=every)
    if is_fleet(chosen, every=every):
        options = ["--name", name] if name else []
        return _change_each("boot install", chosen, password_from, options, argv)
    from ur.request.remote.boot_command import bring_library, make_line, parse_request
    from ur.request.remote.over_ssh import find_robot_file

    address = robot_address(chosen[0] if chosen else None)
    known_as = address.host.removesuffix(".local")
    request = parse_request(argv) if argv else None
    if request and request.page and sys.stdout.isatty():
        need_all(["segno"], "web.lock", "what the page needs (2 MB to download)")
    called = name or (request.name if request else MASTER)
    if request:
        check_name(called, "give --name")
    with connect_robot(address) as shell:
        found = find_robot_file(shell)
        ros2 = found.ros2 if found else None
        if ros2 and not request:
            raise _no_master(known_as)
        copied = bring_library(request, shell, address.user, lambda change: show_changes([change])) if request else 0
        line = make_line(request, shell, known_as, ros2) if request else ""
        become_root(shell, read_lines(password_from, "--password-from", 1)[0])
        count = install_services(
            shell, address.user, called, line, lambda change: show_changes([change]), master=ros2 is None
        )
        if request and request.page and sys.stdout.isatty():
            _show_link(shell, address.host)
    if not count + copied:
        click.echo("nothing to do")
        return 0
    click.echo(f"{address.host} starts it now, and whenever it boots; how it is: ur boot status --robot {known_as}")
    if request and request.page:
        click.echo(f"another link to its page: ur boot link --robot {known_as}")
    return 0


@command.command("link")
@_robot
@click.option("--look", is_flag=True, help="Make a link that allows watching and stopping the robot, but not driving.")
def link(robot: str | None, look: bool) -> int:
    """Print a link, and its QR code, to the page that `ur boot install web` has a robot serve.

    It is valid for one login within an hour.
    """
    need_all(["segno"], "web.lock", "what the page needs (2 MB to download)")
    address = robot_address(robot)
    with connect_robot(address) as shell:
        if not has_service(shell, PAGE):
            known_as = address.host.removesuffix(".local")
            raise user_error(
                f"{address.host} serves no page at boot",
                rule="no-boot-service",
                help=f"ur boot install --robot {known_as} web",
                subject=address.host,
            )
        _show_link(shell, address.host, look=look)
    return 0


@command.command("status")
@_robots
@ALL
def status(robots: tuple[str, ...], every: bool) -> int:
    """Show what the robot starts when it boots, its state, and its last lines.

    The exit code is 1 when one of the services does not run.
    """
    chosen = choose_robots(robots, every=every)
    if is_fleet(chosen, every=every):
        return run_for_each("boot status", chosen, lambda robot: ["boot", "status", "--robot", robot], show="all")
    with connect_robot(robot_address(chosen[0] if chosen else None)) as shell:
        services = parse_status(shell.run(SCRIPT).out)
    lines = [line for service in services for line in describe_status(service)]
    click.echo("\n".join(lines) or "nothing is started at boot")
    return 1 if any(service.active != "active" for service in services) else 0


@command.command("remove")
@_robots
@ALL
@PASSWORD_FROM
@click.argument("names", nargs=-1, metavar="[NAME ...]")
def remove(robots: tuple[str, ...], every: bool, password_from: int | None, names: tuple[str, ...]) -> int:
    """Stop boot services and remove them; without NAME, all of them."""
    for name in names:
        check_name(name, "ur boot status", master=True)
    chosen = choose_robots(robots, every=every)
    if is_fleet(chosen, every=every):
        return _change_each("boot remove", chosen, password_from, [], names)
    with connect_robot(robot_address(chosen[0] if chosen else None)) as shell:
        become_root(shell, read_lines(password_from, "--password-from", 1)[0])
        removed, complete = remove_services(shell, names)
    click.echo("\n".join(removed) or "nothing to remove")
    return 0 if complete else 1


def _change_each(
    command_name: str, robots: Sequence[str], password_from: int | None, options: Sequence[str], argv: Sequence[str]
) -> int:
    passwords = ask_passwords(robots, password_from, root=True)

    def make_argv(robot: str) -> list[str]:
        given = ["--password-from", "0"] if passwords[robot] else []
        return [*command_name.split(), "--robot", robot, *options, *given, "--", *argv]

    return run_for_each(command_name, robots, make_argv, passwords=passwords)


def _show_link(shell: SshShell, host: str, *, look: bool = False) -> None:
    """Have the robot's page admit a new link, and print it. Only the hash of its token is sent to the robot."""
    from ur.web.access.roles import Role
    from ur.web.server.links import FIRST_PORT, LISTENERS, admit_script, draw_code, make_link, make_token

    token = make_token()
    done = shell.run(admit_script(token, Role.LOOK if look else Role.DRIVE))
    if done.code:
        reported = (done.err.strip().splitlines() or ["no reason was given"])[-1]
        raise user_error(f"{host}: no link could be made: {reported}", rule="no-boot-service", help="ur boot status")
    address = make_link(host, FIRST_PORT, token)
    click.echo(draw_code(address, colours=sys.stdout.isatty() and allows_colour(os.environ)))
    click.echo(f"open {address}")
    click.echo("the link is good for one login within an hour; the login outlives reboots")
    click.echo(LISTENERS)


def _no_master(robot: str) -> UserError:
    message = f"{robot} has ROS 2, which needs no master; expected a launch file, program or command"
    return user_error(message, rule="no-boot-service", help="ur boot install robot_base")
