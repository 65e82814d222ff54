"""`ur mcp`: the selected robot for an assistant, and the grants of persons."""

import asyncio
import os
import shlex
import sys
from getpass import getuser
from importlib.util import find_spec

import click

from ur.mcp import NOT_INSTALLED, PACKAGES
from ur.mcp.assistant import ActionLog
from ur.mcp.grants import GrantFiles, grant_files, make_grant
from ur.request.environment import apply_selection, current_selection
from ur.request.requirements.python_packages import need_all
from ur.source.diagnostic import user_error
from ur.source.project import is_installed, project_folder


@click.group("mcp", invoke_without_command=True)
@click.option("--install", is_flag=True, help="Install what assistants need, and serve none.")
@click.pass_context
def command(context: click.Context, install: bool) -> int:
    """Let an assistant look at the robot, and drive it.

    It serves the Model Context Protocol over standard input and output; the assistant's program starts it. Reading
    needs no grant. To drive, the assistant needs one: 'ur mcp grant' gives it in a terminal, or the page of 'ur web',
    for a time, an area and a speed. An assistant on another computer starts it over ssh.

    It starts at once or not at all: what it needs is installed beforehand, by --install or 'ur setup'.
    """
    if context.invoked_subcommand is not None:
        return 0
    if install:
        need_all(*PACKAGES)
        click.echo("what assistants need is installed")
        return 0
    if sys.stdin.isatty():
        message = "standard input is a terminal, expected an assistant's program that starts this command"
        raise user_error(message, rule="not-here", help="docs/how-to/assistant.md names its settings")
    if not all(map(find_spec, PACKAGES[0])):
        ur = "ur" if is_installed() else shlex.quote(str(project_folder() / "ur"))
        raise click.ClickException(NOT_INSTALLED.format(ur))
    apply_selection(current_selection(os.environ))
    from ur.mcp.serve import serve_stdio

    return asyncio.run(serve_stdio())


@command.command("grant")
@click.option("--minutes", type=click.FloatRange(0.1, 1440.0), help="For how long. [default: as it asks, or 30]")
@click.option("--speed", type=click.FloatRange(0.01, 2.0), help="The highest, in m/s. [default: as it asks, or 0.2]")
@click.option("--programs", is_flag=True, help="It may also start and end programs.")
@click.option("--to", metavar="ID", help="The server, where several run; 'ur mcp list' names them.")
def grant(minutes: float | None, speed: float | None, programs: bool, to: str | None) -> int:
    """Let an assistant drive, for a time, at most at a speed; the page of 'ur web' limits areas, too.

    Every screen of the robot shows the grant while the assistant drives; `d` on one of them, or 'ur mcp end', revokes
    it. It has to be typed in a terminal.
    """
    if not sys.stdin.isatty():
        message = "standard input is no terminal, expected a person who gives the grant"
        raise user_error(message, rule="not-here", help="type 'ur mcp grant' in a terminal")
    files = grant_files()
    id = _choose(files, to)
    server = files.list_servers()[id]
    asks = server.asks
    if asks is not None:
        reason = f": {asks.reason}" if asks.reason else ""
        click.echo(f"{server.client} asks for {asks.minutes:g} minutes at {asks.speed:g} m/s{reason}")
    found = make_grant(
        minutes if minutes is not None else asks.minutes if asks else 30.0,
        speed if speed is not None else asks.speed if asks else 0.2,
        (),
        (),
        programs=programs,
    )
    if not click.confirm(f"Let {server.client} drive: {found.text}?", default=False):
        click.echo("no grant is given")
        return 1
    files.give(id, found)
    _note(files, server.client, f"given in a terminal: {found.text}")
    click.echo(f"{found.text}; 'ur mcp end' takes it back, and so does taking over on any screen")
    return 0


@command.command("end")
@click.option("--of", metavar="ID", help="Of this server only; 'ur mcp list' names them.")
def end(of: str | None) -> int:
    """Revoke the grants of all assistants at once."""
    files = grant_files()
    servers = files.list_servers()
    ended = [id for id in ([_choose(files, of)] if of is not None else servers) if files.revoke(id)]
    for id in ended:
        _note(files, servers[id].client, "taken back in a terminal")
    count = len(ended)
    click.echo(f"{count} {'grant was' if count == 1 else 'grants were'} taken back")
    return 0


@command.command("list")
def list_servers() -> int:
    """List the assistants that are served, and their grants."""
    files = grant_files()
    for id, server in files.list_servers().items():
        found = files.find(id)
        state = f"{found.text}, {found.seconds_left() / 60.0:.0f} min left" if found else "may look"
        click.echo(
            f"{id}  {server.client}: {state}" + (f"; asks to drive: {server.asks.reason}" if server.asks else "")
        )
    return 0


@command.command("log")
def log() -> int:
    """Print the requests of assistants, and their results."""
    path = grant_files().log
    if not path.exists():
        click.echo("no assistant has asked for anything", err=True)
        return 0
    click.echo(path.read_text(encoding="utf-8"), nl=False)
    return 0


def _note(files: GrantFiles, client: str, what: str) -> None:
    """Keep who has changed a grant."""
    ActionLog(files.log).add(client, "grant", {}, f"{what}, by {getuser()}")


def _choose(files: GrantFiles, to: str | None) -> str:
    servers = files.list_servers()
    if to is not None and to in servers:
        return to
    if to is None and len(servers) == 1:
        return next(iter(servers))
    names = ", ".join(f"{id} ({each.client})" for id, each in servers.items())
    message = f"{len(servers)} assistants are served, expected one" if to is None else f"unknown server {to!r}"
    help_ = f"give the ID of one of them: {names}" if servers else "start the assistant first"
    raise user_error(message, rule="no-assistant", help=help_)
