"""The options of `ur launch`: roslaunch's, each with its meaning or the reason for a refusal, and additional ones.

They are read without click, whose import takes longer than a large launch file: `ur.cli.launch.command` makes a command
of this table, for help, completion, and messages about mistakes.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from ur.source.arguments import CommandLine, split_argv
from ur.source.diagnostic import user_error

if TYPE_CHECKING:
    from ur.request.launch_request import LaunchOptions, Query

# roslaunch 1.16's own options; there, '--dump-params' may be abbreviated '--dump', which is a different option here.
ROSLAUNCH = (
    "--files", "--args", "--nodes", "--find-node", "--child", "--local", "--screen", "--required", "--log",
    "--server_uri", "--run_id", "--wait", "--port", "--core", "--pid", "--no-summary", "--dump-params",
    "--skip-log-check", "--ros-args", "--disable-title", "--numworkers", "--timeout", "--master-logger-level",
    "--sigint-timeout", "--sigterm-timeout", "--help",
)  # fmt: skip
# roslaunch's options about its summary, the log folder's size and the title have no effect.
_NOTHING_TO_DO = ("--no-summary", "--skip-log-check", "--disable-title")
_NO_CHILD = "ur has no child mode; it is how roslaunch starts itself on other computers"
_QUERIES = ("nodes", "files", "dump_params", "ros_args", "dry_run", "find_node", "args", "dump")


class LaunchOption(NamedTuple):
    """An option. `field` is that of `LaunchOptions`, or a query; numbers are from `least` to `most`, both included."""

    names: tuple[str, ...]
    field: str
    help: str = ""
    kind: Literal["flag", "text", "number", "seconds", "choice"] = "flag"
    metavar: str | None = None
    multiple: bool = False
    default: float | None = None
    least: int = 0
    most: int | None = None
    choices: tuple[str, ...] = ()
    refusal: str = ""


class BadOptionError(Exception):
    """A mistake in a command line. `problem` is '' for an unknown option."""

    def __init__(self, name: str, problem: str = "", option: LaunchOption | None = None) -> None:
        super().__init__(name, problem)
        self.name, self.problem, self.option = name, problem, option


def _flag(*names: str, help: str = "", field: str = "") -> LaunchOption:
    return LaunchOption(names, field or _name_field(names), help)


def _value(
    *names: str, kind: Literal["text", "number", "seconds", "choice"] = "text", field: str = "", **more: Any
) -> LaunchOption:
    return LaunchOption(names, field or _name_field(names), kind=kind, **more)


def _name_field(names: tuple[str, ...]) -> str:
    return next(name for name in names if name.startswith("--"))[2:].replace("-", "_")


LEASE = (
    _flag("--watch", help="If another client drives the robot, watch."),
    _flag("--ask", help="If another client drives the robot, ask to drive."),
    _flag("--take-over", help="If another client drives the robot, take over."),
    _flag("--unattended", help="Let the robot go on with its goal while this computer cannot be reached."),
)
"""For a robot that another client drives; `ur run` passes them on."""

GROUPS: Mapping[str, tuple[LaunchOption, ...]] = {
    "Run and output": (
        _flag("--detach", help="Start it in the background; ur ps, attach, logs and stop find it."),
        _flag("--wait", help="Wait for a master instead of starting one; with --detach: until every node is up."),
        _value(
            "--timeout-ready",
            kind="seconds",
            default=30.0,
            help="With --detach --wait: seconds that nodes get to be up.",
        ),
        _flag("--screen", help="Show the output of every node."),
        _flag("--log", help="Keep the standard output of every node in log files."),
        _flag("--plain", "--no-ui", help="Print lines, as roslaunch does, also on a terminal."),
        _flag("--calm", help="Show one line with the state of the run, and warnings and errors."),
        _flag("--json", help="Print all events as lines of JSON."),
        _flag("-v", field="verbose", help="List files, parameters and nodes before the start."),
    ),
    "Nodes": (
        _value("--only", multiple=True, metavar="NODE", help="Start only this node; may be repeated."),
        _value("--except", field="except_", multiple=True, metavar="NODE", help="Do not start this node."),
        _flag("--no-terminal", help="Leave out nodes that need the terminal, for example with --detach."),
        _value(
            "--prefix", multiple=True, metavar="NODE=PREFIX", help="Start a node with a prefix: 'talker=gdb --args'."
        ),
        _value(
            "--debug",
            multiple=True,
            metavar="NODE[=TOOL]",
            help="Start this node under a debugger: pudb, gdb or debugpy; may be repeated.",
        ),
        _flag("--required", help="End the run with the first node that ends."),
        _value(
            "--respawn-limit",
            kind="number",
            help="Stop respawning a node after so many quick exits (default 10); 0: never, as roslaunch.",
        ),
        _flag("--local", help="Leave nodes for other computers out."),
        _flag("--replace", help="End nodes of other runs that have the same names, as roslaunch does."),
    ),
    "Where another client drives the robot": LEASE,
    "Answer a question, and start nothing": (
        _flag("--dry-run", help="Print what would be started: command, environment and machine of every node."),
        _flag("--ros-args", "--show-args", help="Print the arguments of the launch file."),
        _flag("--nodes", help="Print the names of the nodes."),
        _flag("--files", help="Print the launch files that are read."),
        _value("--find-node", metavar="NODE", help="Print the launch file that defines a node."),
        _value("--args", metavar="NODE", help="Print the command line that starts a node."),
        _flag("--dump-params", help="Print the parameters as YAML."),
        _value("--dump", kind="choice", choices=("json",), help="Print the complete plan of the launch file."),
        _flag("--with-origins", help="With --dump: where everything comes from."),
        _flag("--no-commands", help="With --dump: do not run the programs of <param command>; refuse them."),
    ),
    "Master": (
        _flag("--core", help="Start only a master and rosout, as roscore does."),
        _value("-p", "--port", kind="number", least=1, most=65535, help="Port of the master that is started."),
        _value("-w", "--numworkers", kind="number", least=1, help="Threads of the master that is started."),
        _value("-t", "--timeout", kind="seconds", help="Socket timeout of the master that is started."),
        _value(
            "--master-logger-level",
            kind="choice",
            choices=("debug", "info", "warn", "error", "fatal"),
            help="The log level of the master that is started.",
        ),
    ),
    "Process": (
        _value("--pid", metavar="FILE", help="Write the process id to a file while it runs."),
        _value("--sigint-timeout", kind="seconds", help="Seconds from SIGINT to SIGTERM at the end."),
        _value("--sigterm-timeout", kind="seconds", help="Seconds from SIGTERM to SIGKILL at the end."),
    ),
}
"""The options that the help shows, by the title of their group; `--help` is in the last one, too."""

HIDDEN = (
    # Used by the laptop to start the robot's nodes: see ur.run.remote.share. NAME is this computer's in the launch
    # file.
    _value("--part", metavar="NAME"),
    _value("--runs-already", multiple=True, metavar="NODE"),
    _value("--report", metavar="FILE"),
    *(LaunchOption((name,), "") for name in _NOTHING_TO_DO),
    _value("-c", "--child", refusal=_NO_CHILD),
    _value("-u", "--server_uri", refusal=_NO_CHILD),
    _value("--run_id", refusal="the run id is the master's, or a new one where ur starts the master"),
)
OPTIONS = {name: option for option in (*chain.from_iterable(GROUPS.values()), *HIDDEN) for name in option.names}


def read_launch(argv: Sequence[str]) -> "tuple[CommandLine, LaunchOptions]":
    """Read the arguments of `ur launch`. Raises BadOptionError, and UserError for an option that is refused.

    Unambiguous prefixes of roslaunch's long options are accepted, as optparse does.
    """
    from ur.request.launch_request import LaunchOptions  # for completion it would only cost time

    values: dict[str, Any] = {}
    words: list[str] = []
    left = list(reversed(argv))
    while left:
        word = left.pop()
        if word == "--":
            words += reversed(left)
            break
        if word == "-" or not word.startswith("-"):
            words.append(word)
            continue
        name, sign, value = word.partition("=") if word.startswith("--") else (word[:2], word[2:], word[2:])
        near = [each for each in ROSLAUNCH if each.startswith(name)]
        if name not in OPTIONS and name.startswith("--") and len(near) == 1:
            name = near[0]
        option = OPTIONS.get(name)
        if option is None:
            raise BadOptionError(name)
        if option.kind == "flag":
            if sign and word.startswith("--"):
                raise BadOptionError(name, f"option '{name}' takes no value")
            if sign:
                left.append(f"-{value}")
            values[option.field] = True
            continue
        if not sign and not left:
            raise BadOptionError(name, f"option '{name}' requires a value")
        found = _convert(name, option, value if sign else left.pop())
        if option.refusal:
            short = option.names[0]
            raise user_error(f"{short} is not for ur launch: {option.refusal}", rule="refused-option", subject=short)
        values[option.field] = (*values.get(option.field, ()), found) if option.multiple else found
    values.pop("", None)
    answers = [(name.replace("_", "-"), values.pop(name, None)) for name in _QUERIES]
    queries: list[Query] = [(name, None if given is True else given) for name, given in answers if given is not None]
    options = LaunchOptions(**values, queries=tuple(queries))
    if not words and not options.core:
        raise BadOptionError("", "missing argument '[PACKAGE] FILE [ARG:=VALUE]...'")
    return split_argv(words), options


def _convert(name: str, option: LaunchOption, text: str) -> str | float:
    try:
        match option.kind:
            case "number":
                number = int(text)
                if option.least <= number <= (number if option.most is None else option.most):
                    return number
            case "seconds":
                seconds = float(text)
                if math.isnan(seconds) or 0.0 < seconds <= 1e6:
                    return seconds
            case "choice" if text not in option.choices:
                pass
            case _:
                return text
    except ValueError:
        pass
    raise BadOptionError(name, text, option)
