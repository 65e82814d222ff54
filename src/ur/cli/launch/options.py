"""The options of `ur launch`: roslaunch's, each with its meaning or the reason for a refusal, and additional ones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import click

from ur.source.diagnostic import UserError, error

# roslaunch 1.16's own options; there, '--dump-params' may be abbreviated '--dump', which is a different option here.
ROSLAUNCH = (
    "--files", "--args", "--nodes", "--find-node", "--child", "--local", "--screen", "--required", "--log",
    "--server_uri", "--run_id", "--wait", "--port", "--core", "--pid", "--no-summary", "--dump-params",
    "--skip-log-check", "--ros-args", "--disable-title", "--numworkers", "--timeout", "--master-logger-level",
    "--sigint-timeout", "--sigterm-timeout", "--help",
)  # fmt: skip
_SECONDS = click.FloatRange(min=0, min_open=True, max=1e6)
# roslaunch's options about its summary, the log folder's size and the title have no effect.
_NOTHING_TO_DO = ("--no-summary", "--skip-log-check", "--disable-title")
_REFUSED = {
    "-c": "ur has no child mode; it is how roslaunch starts itself on other computers",
    "-u": "ur has no child mode; it is how roslaunch starts itself on other computers",
    "--run_id": "the run id is the master's, or a new one where ur starts the master",
}


def _flag(*names: str, **more: Any) -> click.Option:
    return click.Option(names, is_flag=True, **more)


def _refuse(ctx: click.Context, param: click.Parameter, value: object) -> None:
    if value and not ctx.resilient_parsing:
        name = param.opts[0]
        raise UserError(error(f"{name} is not for ur launch: {_REFUSED[name]}", rule="refused-option", subject=name))


def make_lease_options() -> tuple[click.Option, ...]:
    """Return the options for a robot that another client drives; `ur run` passes them on."""
    return (
        _flag("--watch", help="If another client drives the robot, watch."),
        _flag("--ask", help="If another client drives the robot, ask to drive."),
        _flag("--take-over", help="If another client drives the robot, take over."),
        _flag("--unattended", help="Let the robot go on with its goal while this computer cannot be reached."),
    )


GROUPS: Mapping[str, tuple[click.Option, ...]] = {
    "Run and output": (
        _flag("--detach", help="Start it in the background; ur ps, attach, logs and stop find it."),
        _flag("--wait", help="Wait for a master instead of starting one; with --detach: until every node is up."),
        click.Option(
            ["--timeout-ready"],
            type=_SECONDS,
            default=30.0,
            show_default=True,
            help="With --detach --wait: seconds that nodes get to be up.",
        ),
        _flag("--screen", help="Show the output of every node."),
        _flag("--log", help="Keep the standard output of every node in log files."),
        _flag("--plain", "--no-ui", help="Print lines, as roslaunch does, also on a terminal."),
        _flag("--calm", help="Show one line with the state of the run, and warnings and errors."),
        _flag("--json", help="Print all events as lines of JSON."),
        _flag("-v", "verbose", help="List files, parameters and nodes before the start."),
    ),
    "Nodes": (
        click.Option(["--only"], multiple=True, metavar="NODE", help="Start only this node; may be repeated."),
        click.Option(["--except", "except_"], multiple=True, metavar="NODE", help="Do not start this node."),
        _flag("--no-terminal", help="Leave out nodes that need the terminal, for example with --detach."),
        click.Option(
            ["--prefix"], multiple=True, metavar="NODE=PREFIX", help="Start a node with a prefix: 'talker=gdb --args'."
        ),
        click.Option(
            ["--debug"],
            multiple=True,
            metavar="NODE[=TOOL]",
            help="Start this node under a debugger: pudb, gdb or debugpy; may be repeated.",
        ),
        _flag("--required", help="End the run with the first node that ends."),
        click.Option(
            ["--respawn-limit"],
            type=click.IntRange(0),
            help="Stop respawning a node after so many quick exits (default 10); 0: never, as roslaunch.",
        ),
        _flag("--local", help="Leave nodes for other computers out."),
        _flag("--replace", help="End nodes of other runs that have the same names, as roslaunch does."),
    ),
    "Where another client drives the robot": make_lease_options(),
    "Answer a question, and start nothing": (
        _flag("--dry-run", help="Print what would be started: command, environment and machine of every node."),
        _flag("--ros-args", help="Print the arguments of the launch file."),
        _flag("--nodes", help="Print the names of the nodes."),
        _flag("--files", help="Print the launch files that are read."),
        click.Option(["--find-node"], metavar="NODE", help="Print the launch file that defines a node."),
        click.Option(["--args"], metavar="NODE", help="Print the command line that starts a node."),
        _flag("--dump-params", help="Print the parameters as YAML."),
        click.Option(["--dump"], type=click.Choice(["json"]), help="Print the complete plan of the launch file."),
        _flag("--with-origins", help="With --dump: where everything comes from."),
        _flag("--no-commands", help="With --dump: do not run the programs of <param command>; refuse them."),
    ),
    "Master": (
        _flag("--core", help="Start only a master and rosout, as roscore does."),
        click.Option(["-p", "--port"], type=click.IntRange(1, 65535), help="Port of the master that is started."),
        click.Option(["-w", "--numworkers"], type=click.IntRange(1), help="Threads of the master that is started."),
        click.Option(["-t", "--timeout"], type=_SECONDS, help="Socket timeout of the master that is started."),
        click.Option(
            ["--master-logger-level"],
            type=click.Choice(["debug", "info", "warn", "error", "fatal"]),
            help="The log level of the master that is started.",
        ),
    ),
    "Process": (
        click.Option(["--pid"], metavar="FILE", help="Write the process id to a file while it runs."),
        click.Option(["--sigint-timeout"], type=_SECONDS, help="Seconds from SIGINT to SIGTERM at the end."),
        click.Option(["--sigterm-timeout"], type=_SECONDS, help="Seconds from SIGTERM to SIGKILL at the end."),
    ),
}
"""The options that the help shows, by the title of their group; `--help` is in the last one, too."""

_HIDDEN = (
    # Used by the laptop to start the robot's nodes: see ur.run.remote.share. NAME is this computer's in the launch
    # file.
    click.Option(["--part"], hidden=True, metavar="NAME"),
    click.Option(["--runs-already"], hidden=True, multiple=True, metavar="NODE"),
    click.Option(["--report"], hidden=True, metavar="FILE"),
    *(_flag(name, hidden=True, expose_value=False) for name in _NOTHING_TO_DO),
    *(
        click.Option(names, hidden=True, expose_value=False, callback=_refuse)
        for names in (["-c", "--child"], ["-u", "--server_uri"], ["--run_id"])
    ),
)
PARAMETERS: tuple[click.Parameter, ...] = (
    *chain.from_iterable(GROUPS.values()),
    *_HIDDEN,
    click.Argument(["argv"], nargs=-1, required=False, metavar="[PACKAGE] FILE [ARG:=VALUE]..."),
)


def list_groups() -> dict[str, list[str]]:
    """Return the titles of the groups, each with a name of each of its options."""
    groups = {title: [option.opts[-1] for option in options] for title, options in GROUPS.items()}
    groups["Process"].append("--help")
    return groups


class LaunchCommand(click.Command):
    """A command that also accepts unambiguous prefixes of roslaunch's long options, as optparse does."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse a command line."""
        known = {name for param in self.params for name in (*param.opts, *param.secondary_opts)}
        return super().parse_args(ctx, list(_complete_options(args, known)))


def _complete_options(argv: Sequence[str], known: set[str]) -> Iterator[str]:
    for number, argument in enumerate(argv):
        if argument == "--":
            yield from argv[number:]
            return
        name, sign, value = argument.partition("=")
        near = [each for each in ROSLAUNCH if each.startswith(name)]
        if name.startswith("--") and name not in known and len(near) == 1:
            name = near[0]
        yield name + sign + value
