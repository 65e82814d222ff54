"""Commands for several robots: selection, passwords, and a process for each, with one line each."""

from __future__ import annotations

import getpass
import json
import os
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Literal

import click

from ur.cli.output import read_lines
from ur.fleet.jobs import Fleet, Job, JobStatus, describe_end, describe_fleet, find_exit_code, summarise
from ur.fleet.processes import Output, Processes, logs_folder
from ur.request.remote.connection import robot_address
from ur.robot.discovery.record import load_records, records_folder
from ur.robot.ssh.failures import explain_failure
from ur.robot.ssh.openssh import STRICT
from ur.robot.ssh.secret import Secret
from ur.source.ansi import BOLD, paint
from ur.source.diagnostic import user_error
from ur.source.foreign.json_values import read_json
from ur.source.printable import printable_lines
from ur.source.progress_line import show_progress
from ur.source.render import shows_colour

if TYPE_CHECKING:
    from rich.live import Live

_LONGEST_REPORT = 64 << 20  # characters
MOST_LINES = 60  # lines of one robot's output that are printed after the table; its file has all of them
ALL = click.option("--all", "every", is_flag=True, help="All robots that were set up from this computer, in parallel.")


def choose_robots(named: Sequence[str], *, every: bool) -> tuple[str, ...]:
    """Return the robots of a command line, which may be joined by commas; with `every`, all known to be set up.

    Each robot is returned once. Raises UserError for `--all` beside a name, unknown robots, or an invalid address.
    """
    names = [name for text in named for name in text.split(",") if name]
    if every and names:
        raise click.UsageError("--all stands for every robot, expected no name beside it")
    if every:
        names = [record.name for record in load_records(records_folder(os.environ))]
        if not names:
            message = "--all: no robot was set up from this computer, expected at least one"
            raise user_error(message, rule="no-robot", help="run: ur robot setup HOST; or name the robots")
    return tuple({str(robot_address(name)): name for name in reversed(names)}.values())[::-1]


def read_names(named: Sequence[str]) -> frozenset[str]:
    """Return the names of robots on a command line, without user and .local.

    Raises UserError for an invalid address.
    """
    return frozenset(robot_address(name).host.removesuffix(".local") for name in choose_robots(named, every=False))


def is_fleet(robots: Sequence[str], *, every: bool) -> bool:
    """Return whether a command line names several robots, or all, however many those are."""
    return every or len(robots) > 1


def run_for_each(
    verb: str,
    robots: Sequence[str],
    make_argv: Callable[[str], Sequence[str]],
    *,
    passwords: Mapping[str, Secret | None] | None = None,
    show: Literal["failed", "all"] = "failed",
    question: str = "",
    confirmed: bool = True,
) -> int:
    """Run `ur` once for each robot, side by side, and print a line for each; return the highest exit code.

    `make_argv` returns the arguments of `ur`; a password is passed to the standard input of its process. Output is
    printed after the table: of processes that failed, or of `all`. With a `question`, the commands stop before they
    change anything and ask (`answer_confirmed`); then their output is printed, and the question asked for all, unless
    it is `confirmed`.
    """
    jobs = [_make_job(name, make_argv(name), (passwords or {}).get(name), asks=bool(question)) for name in robots]
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    table = _Table()
    with _open_processes(jobs, verb) as processes:

        def confirm(_: Fleet, outputs: Sequence[Output]) -> bool:
            with table.paused():
                _print_outputs(processes.fleet, outputs, "all")
                return confirmed or _agree(question)

        try:
            with table:
                fleet = processes.run(table.show, confirm if question else None)
        except KeyboardInterrupt:
            click.echo(summarise(processes.fleet))
            raise
        _print_outputs(fleet, processes.outputs, show)
    click.echo(summarise(fleet))
    return find_exit_code(fleet)


def print_json_of_each(
    verb: str,
    robots: Sequence[str],
    make_argv: Callable[[str], Sequence[str]],
    passwords: Mapping[str, Secret | None] | None = None,
) -> int:
    """Run commands that print JSON, and print one list: an object for each robot with its name and exit code."""
    jobs = [_make_job(name, make_argv(name), (passwords or {}).get(name)) for name in robots]
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with _open_processes(jobs, verb, errors_apart=True) as processes, show_progress(f"{verb}: {len(jobs)} robots"):
        fleet = processes.run(lambda _fleet, _now: None)
        found = [_as_dict(status, output) for status, output in zip(fleet, processes.outputs, strict=True)]
    click.echo(json.dumps(found, indent=2))
    return find_exit_code(fleet)


def ask_passwords(robots: Sequence[str], descriptor: int | None, *, root: bool) -> dict[str, Secret | None]:
    """Return the password of each robot; None for one that needs none, or if no user can be asked.

    One password for all is read from `descriptor`; else, on a terminal, it is asked for once, for those robots that
    refuse the key, or, with `root`, whose sudo requires a password. Raises UserError if the descriptor cannot be read.
    """
    if descriptor is not None:
        line = read_lines(descriptor, "--password-from", 1)[0]
        return dict.fromkeys(robots, Secret(line) if line else None)
    none: dict[str, Secret | None] = dict.fromkeys(robots)
    if not sys.stdin.isatty():
        return none
    needing = _find_needing(robots, root=root)
    if not needing:
        return none
    text = getpass.getpass(f"password of {', '.join(str(robot_address(name)) for name in needing)} (empty: none): ")
    return none | dict.fromkeys(needing, Secret(text)) if text else none


def _find_needing(robots: Sequence[str], *, root: bool) -> list[str]:
    """Return the robots that refuse the key, or whose sudo requires a password."""
    script = "sudo -k -n true" if root else "true"
    jobs = [
        Job(name, ("ssh", *STRICT, "-o", "BatchMode=yes", "-T", "--", str(robot_address(name)), script))
        for name in robots
    ]
    with _open_processes(jobs, "login") as processes, show_progress(f"logging in to {len(jobs)} robots"):
        fleet = processes.run(lambda _fleet, _now: None)
        reported = [output.log.read_all() for output in processes.outputs]
    return [
        status.name
        for status, text in zip(fleet, reported, strict=True)
        if status.code
        and (status.code != 255 or (explain_failure(robot_address(status.name), text).diagnostics[0].rule == "refused"))
    ]


def _make_job(name: str, argv: Sequence[str], password: Secret | None, *, asks: bool = False) -> Job:
    # Unbuffered, so that the table shows the present state.
    command = (sys.executable, "-I", "-u", "-m", "ur", *argv)
    return Job(name, command, stdin=f"{password.reveal()}\n" if password else "", asks=asks)


def _open_processes(jobs: Sequence[Job], verb: str, *, errors_apart: bool = False) -> Processes:
    folder = logs_folder(os.environ)
    try:
        return Processes(jobs, folder, verb, errors_apart=errors_apart)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"{folder}: the output of the robots cannot be kept there: {reason}"
        help = f"is there room, and is it yours? ls -ld {folder}"
        raise user_error(message, rule="unwritable-file", help=help) from None


def _agree(question: str) -> bool:
    if not sys.stdin.isatty():
        message = "there is no terminal to ask on, so nothing was changed"
        click.echo(f"error: {message}\n  help: --yes makes these changes", err=True)
        return False
    return click.confirm(question, default=True)


def _print_outputs(fleet: Fleet, outputs: Sequence[Output], show: Literal["failed", "all"]) -> None:
    """Print the output of the robots' commands one after the other, each under the name of its robot."""
    for status, output in zip(fleet, outputs, strict=True):
        text = output.log.read_all().rstrip()
        if not text or (show == "failed" and not status.code):
            continue
        lines = text.splitlines()
        click.echo(paint(f"{status.name}:", BOLD) if shows_colour(sys.stdout) else f"{status.name}:")
        if len(lines) > MOST_LINES:
            click.echo(f"  ... ({len(lines) - MOST_LINES} more lines: {output.log.path})")
        for line in lines[-MOST_LINES:]:
            click.echo(f"  {printable_lines(line)}".rstrip())


def _as_dict(status: JobStatus, output: Output) -> dict[str, object]:
    try:
        reported = read_json(output.log.read_all(), dict[str, object], _LONGEST_REPORT)
    except ValueError:
        reported = {}
    errors = output.errors.read_all().strip() if output.errors else ""
    row: dict[str, object] = {"robot": status.name, "code": status.code, "error": errors}
    return row | reported


class _Table:
    """The lines of all robots: redrawn repeatedly on a terminal; else one line per robot when it is done."""

    def __init__(self) -> None:
        self._live: Live | None = None
        self._reported: set[str] = set()
        self._is_live = sys.stdout.isatty() and os.environ.get("TERM", "dumb") not in ("dumb", "")

    def __enter__(self) -> _Table:
        if self._is_live:
            from rich.live import Live

            self._live = Live(auto_refresh=False)
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live:
            self._live.stop()
            self._live = None

    def show(self, fleet: Fleet, now: float) -> None:
        """Show the present state."""
        if self._live:
            from rich.text import Text

            lines = describe_fleet(fleet, now)
            self._live.update(Text("\n".join(lines), no_wrap=True, overflow="ellipsis"), refresh=True)
            return
        for status in fleet:
            if status.phase == "done" and status.name not in self._reported:
                self._reported.add(status.name)
                click.echo(describe_end(status))
                sys.stdout.flush()

    def paused(self) -> AbstractContextManager[object]:
        """Release the terminal for other output while the context lasts; the table is drawn again below it."""
        return _Pause(self) if self._live else nullcontext()


class _Pause:
    def __init__(self, table: _Table) -> None:
        self._table = table

    def __enter__(self) -> None:
        self._table.__exit__()

    def __exit__(self, *_: object) -> None:
        self._table.__enter__()
