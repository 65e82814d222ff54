"""The `ur` command: finds the verb, runs it, and turns whatever goes wrong into one clear line."""

from __future__ import annotations

import errno
import os
import shlex
import sys
from collections.abc import Sequence
from importlib import import_module

import click

from ur.source.diagnostic import UserError
from ur.source.printable import OutputLost, guard_output, printable
from ur.source.render import render_human, shows_colour
from ur.source.suggest import did_you_mean

HELP = "Finds, selects and drives small ROS robots, simulated or real, and starts launch files."
EPILOG = "First drive: ur run keyboard_navigate"

# The summary stands here so that `ur --help` imports no verb; a test compares it with the verb's own.
VERBS = {
    "run": ("ur.cli.launch.run", "Run a program on the selected robot."),
    "list": ("ur.cli.launch.list_programs", "List the programs that `ur run` knows."),
    "launch": ("ur.cli.launch.launch", "Start a launch file, in place of roslaunch."),
    "ps": ("ur.cli.runs.ps", "List the runs on this computer."),
    "attach": ("ur.cli.runs.attach", "Show what a run prints, from any terminal."),
    "logs": ("ur.cli.runs.logs", "Print what a node has printed so far."),
    "restart": ("ur.cli.runs.restart", "Stop a node and start it again."),
    "wait": ("ur.cli.runs.wait", "Return when every node of a run is up."),
    "stop": ("ur.cli.runs.stop", "End a run, or one of its nodes."),
    "check": ("ur.cli.files.check", "Check launch files, YAML files and programs."),
    "new": ("ur.cli.files.new", "Write a new node, group, view, program, base, package or world."),
    "package": ("ur.cli.files.package", "Check package.xml and CMakeLists.txt of launch files."),
    "format": ("ur.cli.files.format", "Put launch files into a standard order and layout."),
    "find": ("ur.cli.files.find", "Find where a name in launch files is defined and used."),
    "docs": ("ur.cli.files.docs", "Write documents of launch files: one page, or a web site."),
    "graph": ("ur.cli.files.graph", "Draw what a launch file includes and starts, or what runs."),
    "explain": ("ur.cli.files.explain", "Explain where a name in a launch file got its value."),
    "use": ("ur.cli.robots.use", "Select a robot, or show which one is selected."),
    "setup": ("ur.cli.computer.setup", "Set this computer up: shells, keys, workspace, names."),
    "robots": ("ur.cli.robots.robots", "List the robots on the network, and those known but away."),
    "shell": ("ur.cli.robots.shell", "Open a shell on a robot, or run one command there."),
    "x": ("ur.cli.robots.x", "Run a program on a robot with its windows here."),
    "sync": ("ur.cli.robots.sync", "Synchronise the workspaces of this computer and a robot."),
    "build": ("ur.cli.robots.build", "Build the catkin workspace here or on a robot."),
    "mount": ("ur.cli.robots.mount", "Mount a folder of a robot here."),
    "unmount": ("ur.cli.robots.unmount", "Unmount the folders of a robot."),
    "doctor": ("ur.cli.computer.doctor", "Find what is wrong between this computer and a robot."),
    "wifi": ("ur.cli.robots.wifi", "Measure the connection to a robot: signal of both, latency, loss."),
    "robot": ("ur.cli.robot_setup.robot", "Set robots up and change them, over the network."),
    "image": ("ur.cli.robot_setup.image", "Prepare images for the first boot of robots."),
    "boot": ("ur.cli.robots.boot", "Choose what a robot starts when it boots."),
    "completion": ("ur.cli.computer.completion", "Print the lines that let a shell complete `ur` with Tab."),
    "debian": ("ur.cli.computer.debian", "Inspect, change or remove the Debian root that ROS runs in."),
    "env": ("ur.cli.computer.env", "Print the lines that let a shell follow the selection."),
}


class VerbGroup(click.Group):
    """The verbs, each imported when it is used."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """The names, most important first."""
        return list(VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002 - click's signature
        """Import a verb."""
        return load_verb(cmd_name) if cmd_name in VERBS else None


def load_verb(name: str) -> click.Command:
    """The command behind a verb's name: `command` of its module."""
    verb = import_module(VERBS[name][0]).command
    assert isinstance(verb, click.Command)
    return verb


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `ur` with its arguments (default: of this process) and return the exit code. Raises nothing."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    open_closed_streams()
    os.umask(os.umask(0o077) | 0o002)  # as in ur.__main__
    with guard_output():
        return _run(words)


def _run(words: list[str]) -> int:
    try:
        code = _dispatch(words)
        sys.stdout.flush()
        return code
    except click.UsageError as problem:
        return _explain(problem, words)
    except click.ClickException as problem:
        _say(f"error: {problem.format_message()}")
        return 2
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics, colour=shows_colour(sys.stderr)))
        return 2
    except (KeyboardInterrupt, click.Abort):
        return 130
    except Exception as problem:
        return explain_exception(problem, words)


def _dispatch(words: list[str]) -> int:
    if not words or words[0] in ("--help", "-h", "help"):
        from ur.cli.help import show_help

        show_help(words[1:] if words and words[0] == "help" else [])
        return 0
    if words[0] in VERBS and _wants_help(words):
        from ur.cli.help import show_help

        show_help(words)
        return 0
    group = VerbGroup("ur", params=[_version_option()], help=HELP)
    try:
        with group.make_context("ur", words, color=None if shows_colour(sys.stdout) else False) as context:
            result = group.invoke(context)
    except click.exceptions.Exit as end:
        return end.exit_code
    return result if isinstance(result, int) else 0


def _wants_help(words: list[str]) -> bool:
    # What follows a program or a command of another computer is its own.
    end = 2 if words[0] == "run" else len(words)
    return any(word in ("--help", "-h") for word in words[1:end])


def _version_option() -> click.Option:
    def show(ctx: click.Context, _param: click.Parameter, value: bool) -> None:
        if value:
            from importlib.metadata import version

            from ur.source.project import DISTRIBUTION, describe_origin

            click.echo(f"ur {version(DISTRIBUTION)} ({describe_origin()})")
            ctx.exit(0)

    return click.Option(
        ["--version"], is_flag=True, expose_value=False, is_eager=True, callback=show, help="Print the version."
    )


def _explain(problem: click.UsageError, words: Sequence[str]) -> int:
    """One line for a wrong command line, one more that helps."""
    verb = problem.ctx.command.name if problem.ctx is not None and problem.ctx.parent is not None else None
    where = problem.ctx.command_path if verb and problem.ctx else "ur"
    if problem.ctx is None and words[0] in VERBS:  # click does not say where an option lacks its value
        where = _name_command(words)
    message = problem.format_message().rstrip(".")
    help_line = f"'{where} --help' lists the options"
    if isinstance(problem, click.BadParameter) and (wanted := _describe_values(problem.param)):
        assert problem.param is not None
        given = problem.message.partition(" is not ")[0].strip("'")
        named = isinstance(problem.param, click.Option)
        target = f" for {max(problem.param.opts, key=len)}" if named else ""
        message = f"{where}: invalid value {given!r}{target}, expected {wanted}"
    elif isinstance(problem, click.BadOptionUsage) and not isinstance(problem, click.NoSuchOption):
        message = f"{where}: option '{problem.option_name}' requires a value"
    elif isinstance(problem, click.NoSuchOption):
        message = f"{where}: unknown option '{problem.option_name}'"
        names = [name for param in problem.ctx.command.params for name in param.opts] if problem.ctx else []
        near = did_you_mean(problem.option_name, names)
        help_line = f"did you mean {near!r}?" if near else help_line
    elif verb is None and message.startswith("No such command"):
        word = message.split("'")[1]
        message = f"unknown command {word!r}"
        help_line = _suggest_command(word) or "'ur --help' lists the commands"
    elif problem.ctx is not None and message.startswith("No such command"):
        word = message.split("'")[1]
        near = did_you_mean(word, getattr(problem.ctx.command, "commands", ()))
        message = f"unknown command {f'{where} {word}'!r}"
        help_line = f"did you mean '{where} {near}'?" if near else f"'{where} --help' lists the commands"
    else:
        message = f"{where}: {message[:1].lower()}{message[1:]}"
        if where == "ur run" and isinstance(problem, click.MissingParameter):
            help_line = "'ur list' lists the programs"
    _say(f"error: {message}\n  help: {help_line}")
    return 2


def _suggest_command(word: str) -> str | None:
    # A launch file or a program alone: the verb was left out.
    if word.endswith((".launch", ".launch.xml")):
        return f"start a launch file: ur launch {word}"
    from ur.request.environment import PACKAGE, know_own_package
    from ur.request.programs import index_programs

    programs = {program.name for program in index_programs(PACKAGE, know_own_package(os.environ)).programs}
    near = did_you_mean(word, VERBS) if word not in programs else None
    if near:
        return f"did you mean 'ur {near}'?"
    near = did_you_mean(word, programs)
    return f"did you mean 'ur run {near}'?" if near else None


def _name_command(words: Sequence[str]) -> str:
    """The command that a command line calls: 'ur robot setup'."""
    command = load_verb(words[0])
    inner = getattr(command, "commands", {})
    name = next((word for word in words[1:] if word in inner), "")
    return f"ur {words[0]} {name}".rstrip()


def _describe_values(param: click.Parameter | None) -> str:
    """The values that an option takes: 'a whole number from 1 to 65535', 'bash, fish or zsh'; '' for any text."""
    kind = param.type if param is not None else None
    if isinstance(kind, click.Choice):
        *some, last = map(str, kind.choices)
        return f"{', '.join(some)} or {last}" if some else last
    if not isinstance(kind, click.types.IntParamType | click.types.FloatParamType):
        return ""
    text = "a whole number" if isinstance(kind, click.types.IntParamType) else "a number"
    least, most = (
        None if bound is None else f"{bound:f}".rstrip("0").rstrip(".") if bound % 1 else f"{bound:.0f}"
        for bound in (getattr(kind, "min", None), getattr(kind, "max", None))
    )
    is_open = getattr(kind, "min_open", False)
    if least is None:
        return text if most is None else f"{text} up to {most}"
    if most is None:
        return f"{text} above {least}" if is_open else f"{text} from {least} up"
    return f"{text} above {least}, up to {most}" if is_open else f"{text} from {least} to {most}"


def open_closed_streams() -> None:
    """Put something in place of standard output and error that are closed: else files that are opened take it."""
    for number, name, flags in ((1, "stdout", os.O_RDONLY), (2, "stderr", os.O_WRONLY)):
        if getattr(sys, name) is None:
            opened = os.open(os.devnull, flags)
            if opened != number:
                os.dup2(opened, number)
                os.close(opened)
            # What is written to standard output is refused, as on a full disk; nobody could be told of errors.
            setattr(sys, name, os.fdopen(number, "w", encoding="utf-8", closefd=False))


_REFUSALS = {  # of the system, which are no defect of this program
    errno.EACCES: "list the permissions of all folders above it: namei -l {}",
    errno.EPERM: "list the permissions of all folders above it: namei -l {}",
    errno.ENAMETOOLONG: "choose a shorter name",
    errno.EROFS: "choose a folder of a file system that can be written",
    errno.ENOSPC: "make room on the disk (df -h), then run this again",
    errno.EDQUOT: "make room below your quota, then run this again",
}


def explain_exception(problem: Exception, words: list[str]) -> int:
    """Say in one line that output, the current folder or a file cannot be used; anything else is a defect.

    Returns the exit code.
    """
    if isinstance(problem, OutputLost):
        if isinstance(problem.reason, BrokenPipeError):
            return 141
        reason = (problem.reason.strerror or str(problem.reason)).lower()
        _say(f"error: standard output cannot be written: {reason}")
        _say("  help: is the disk full, or standard output closed? then run this again")
        return 2
    if isinstance(problem, OSError) and not _has_folder():
        _say("error: the current folder does not exist any more, expected one to work in")
        _say("  help: cd to another folder, then run this again")
        return 2
    if isinstance(problem, OSError) and problem.errno in _REFUSALS and isinstance(problem.filename, (str, bytes)):
        name = printable(os.fsdecode(problem.filename))
        _say(f"error: '{name}' cannot be used: {(problem.strerror or str(problem)).lower()}")
        _say(f"  help: {_REFUSALS[problem.errno].format(shlex.quote(name))}")
        return 2
    return report_defect(problem, words)


def _has_folder() -> bool:
    try:
        os.getcwd()  # noqa: PTH109 - asks the system, and nothing else
    except OSError:
        return False
    return True


def report_defect(problem: Exception, words: list[str]) -> int:
    """Write down what only a developer can use, and tell where it is; returns the exit code."""
    from pathlib import Path

    from ur.source.crash import write_crash_report
    from ur.source.user_folders import user_folder

    folder = Path(user_folder("XDG_STATE_HOME", os.environ), "ubiquity_launches")
    path = write_crash_report(problem, "ur", [folder], words)
    _say(
        f"error: internal error in 'ur {printable(' '.join(words))}': "
        f"{type(problem).__name__}: {printable(str(problem))}"
    )
    _say(f"  help: please report it with the file {path}" if path else "  help: please report it")
    return 2


def _say(text: str) -> None:
    try:
        sys.stderr.write(text + "\n")
    except OSError:
        return
