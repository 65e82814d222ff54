"""The options of `ur launch` as values; without click, whose import is a sixth of the start of a run."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from ur.source.diagnostic import UserError, error

if TYPE_CHECKING:
    from ur.run.clients.protocol import Severity
    from ur.run.remote.lease import Mode

Report = Callable[["Severity", str], None]
Query = tuple[str, str | None]
_PRECEDENCE = (
    "args",
    "find-node",
    "dump-params",
    "files",
    "ros-args",
    "nodes",
    "dry-run",
    "dump",
)  # as roslaunch's main
_OURS = {"dry-run", "dump"}
_EXCLUSIVE = {"nodes", "find-node", "args", "ros-args"}


class LaunchOptions(NamedTuple):
    """The options of a command line."""

    core: bool = False
    local: bool = False
    part: str | None = None  # only the nodes of this machine, which is this computer
    runs_already: Sequence[str] = ()  # nodes of that part that are not to be started again
    verbose: bool = False
    screen: bool = False
    log: bool = False
    required: bool = False
    wait: bool = False
    port: int | None = None
    numworkers: int | None = None
    timeout: float | None = None
    master_logger_level: str | None = None
    pid: str | None = None
    sigint_timeout: float | None = None
    sigterm_timeout: float | None = None
    only: Sequence[str] = ()
    except_: Sequence[str] = ()
    no_terminal: bool = False
    prefix: Sequence[str] = ()
    debug: Sequence[str] = ()
    detach: bool = False
    plain: bool = False
    calm: bool = False
    json: bool = False
    timeout_ready: float = 30.0
    respawn_limit: int | None = None
    watch: bool = False  # these three: the conduct where another client drives the robot
    ask: bool = False
    take_over: bool = False
    unattended: bool = False
    replace: bool = False
    report: str | None = None  # a file for errors before the start, as JSON
    queries: Sequence[Query] = ()
    with_origins: bool = False  # these two: of --dump
    no_commands: bool = False
    # Of `ur run` and `ur replay`: arguments that it does not declare are refused, and a failed required node counts.
    program: str = ""

    @property
    def mode(self) -> Mode:
        """The mode that the options set for a robot that another client drives."""
        return "watch" if self.watch else "ask" if self.ask else "take" if self.take_over else "drive"


class StartReporter:
    """Prints lines before the start, and stores them for the log of the run's interface."""

    def __init__(self) -> None:
        self.notices: list[tuple[Severity, str]] = []

    def report(self, severity: Severity, text: str) -> None:
        """Print a line on standard error."""
        self.notices.append((severity, text))
        sys.stderr.write(f"{text}\n")


def choose_query(queries: Sequence[Query]) -> Query | None:
    """Return the query that is answered, since roslaunch accepts several; None without one."""
    return min(queries, key=lambda query: _PRECEDENCE.index(query[0]), default=None)


def check_options(names: Sequence[str], options: LaunchOptions) -> None:
    """Raise UserError for options and arguments that exclude each other."""
    if options.core and (names or options.wait or options.queries):
        raise UserError(
            error("--core starts a master alone, expected no launch file, --wait or question", rule="bad-options")
        )
    if names.count("-") > 1:
        raise UserError(error("'-' is standard input, expected it once", rule="bad-options"))
    if options.screen and options.log:
        raise UserError(error("--screen and --log cannot be used together", rule="bad-options"))
    modes = [name for name in ("watch", "ask", "take_over") if getattr(options, name)]
    if len(modes) > 1:
        text = " and ".join(f"--{name.replace('_', '-')}" for name in modes)
        raise UserError(error(f"{text} cannot be used together", rule="bad-options"))
    if options.detach and options.json:
        help_ = "'ur attach --json' prints the events of a run that is detached"
        raise UserError(error("--detach and --json cannot be used together", rule="bad-options", help=help_))
    if (options.with_origins or options.no_commands) and not any(name == "dump" for name, _ in options.queries):
        raise UserError(error("--with-origins and --no-commands belong to --dump json", rule="bad-options"))
    _check_seconds(options)
    names = [name for name, _ in options.queries]
    if len([name for name in names if name in _EXCLUSIVE]) > 1 or (len(names) > 1 and set(names) & _OURS):
        raise UserError(
            error(f"{' and '.join(f'--{name}' for name in names)} cannot be used together", rule="bad-options")
        )


def _check_seconds(options: LaunchOptions) -> None:
    """Raise UserError for times that are not valid numbers."""
    for name in ("timeout", "sigint_timeout", "sigterm_timeout", "timeout_ready"):
        value = getattr(options, name)
        if value is not None and value != value:
            option = name.replace("_", "-")
            raise UserError(
                error(f"--{option} nan, expected a number of seconds above 0", rule="bad-options", subject=option)
            )
