"""The `ur` command: finds the verb, runs it, and turns whatever goes wrong into one clear line."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib import import_module

import click

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur.source.suggest import did_you_mean

HELP = "Finds, selects and drives small ROS robots, simulated or real, and starts launch files."
EPILOG = "First drive: ur run keyboard_navigate"

# The summary stands here so that `ur --help` imports no verb; a test compares it with the verb's own.
VERBS = {
    "run": ("ur.cli.run", "Run a program on the selected robot."),
    "list": ("ur.cli.list_programs", "List the programs that `ur run` knows."),
    "launch": ("ur.cli.launch", "Start a launch file, in place of roslaunch."),
    "ps": ("ur.cli.ps", "List the runs on this computer."),
    "attach": ("ur.cli.attach", "Show what a run prints, from any terminal."),
    "logs": ("ur.cli.logs", "Print what a node has printed so far."),
    "restart": ("ur.cli.restart", "Stop a node and start it again."),
    "wait": ("ur.cli.wait", "Return when every node of a run is up."),
    "stop": ("ur.cli.stop", "End a run, or one of its nodes."),
    "check": ("ur.cli.check", "Check launch files, YAML files and programs."),
    "new": ("ur.cli.new", "Write a new node, group, view, program, base or package."),
    "package": ("ur.cli.package", "Check package.xml and CMakeLists.txt of launch files."),
    "format": ("ur.cli.format", "Put launch files in house order and layout."),
    "find": ("ur.cli.find", "Find where a name in launch files is defined and used."),
    "docs": ("ur.cli.docs", "Write documents of launch files: one page, or a web site."),
    "graph": ("ur.cli.graph", "Draw what a launch file includes and starts, or what runs."),
    "explain": ("ur.cli.explain", "Say where a name in a launch file got its value."),
    "use": ("ur.cli.use", "Select a robot, or show which one is selected."),
    "setup": ("ur.cli.setup", "Set this computer up: shells, keys, workspace, names."),
    "robots": ("ur.cli.robots", "List the robots on the network, and those known but away."),
    "shell": ("ur.cli.shell", "Open a shell on a robot, or run one command there."),
    "x": ("ur.cli.x", "Run a program on a robot with its windows here."),
    "sync": ("ur.cli.sync", "Bring the workspaces here and on a robot in step."),
    "build": ("ur.cli.build", "Build the catkin workspace here or on a robot."),
    "mount": ("ur.cli.mount", "Mount a folder of a robot here."),
    "unmount": ("ur.cli.unmount", "Take the mounted folders of a robot away again."),
    "doctor": ("ur.cli.doctor", "Find what is wrong between this computer and a robot."),
    "wifi": ("ur.cli.wifi", "Measure the way to a robot: signal of both, latency, loss."),
    "robot": ("ur.cli.robot", "Set robots up and change them, over the network."),
    "image": ("ur.cli.image", "Prepare images for the first boot of robots."),
    "boot": ("ur.cli.boot", "Choose what a robot starts when it boots."),
    "completion": ("ur.cli.completion", "Print what makes a shell complete `ur` with Tab."),
    "env": ("ur.cli.env", "Print what makes a shell follow the selection."),
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
    try:
        return _dispatch(words)
    except click.UsageError as problem:
        return _explain(problem)
    except click.ClickException as problem:
        _say(f"error: {problem.format_message()}")
        return 2
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics, colour=sys.stderr.isatty()))
        return 2
    except (KeyboardInterrupt, click.Abort):
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Python flushes standard output once more when it ends
        return 141
    except Exception as problem:
        return report_defect(problem, words)


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
        with group.make_context("ur", words) as context:
            result = group.invoke(context)
    except click.exceptions.Exit as end:
        return end.exit_code
    return result if isinstance(result, int) else 0


def _wants_help(words: list[str]) -> bool:
    # `ur run PROGRAM --help` is about the program.
    end = 2 if words[0] == "run" else len(words)
    return any(word in ("--help", "-h") for word in words[1:end])


def _version_option() -> click.Option:
    def show(ctx: click.Context, _param: click.Parameter, value: bool) -> None:
        if value:
            from importlib.metadata import version

            click.echo(f"ur {version('ubiquity-launches')}")
            ctx.exit(0)

    return click.Option(
        ["--version"], is_flag=True, expose_value=False, is_eager=True, callback=show, help="Print the version."
    )


def _explain(problem: click.UsageError) -> int:
    """One line for a wrong command line, one more that helps."""
    verb = problem.ctx.command.name if problem.ctx is not None and problem.ctx.parent is not None else None
    where = problem.ctx.command_path if verb and problem.ctx else "ur"
    message = problem.format_message().rstrip(".")
    help_line = f"'{where} --help' shows what there is"
    if isinstance(problem, click.NoSuchOption):
        message = f"{problem.option_name} is not an option of '{where}'"
        names = [name for param in problem.ctx.command.params for name in param.opts] if problem.ctx else []
        near = did_you_mean(problem.option_name, names)
        help_line = f"did you mean {near!r}?" if near else help_line
    elif verb is None and message.startswith("No such command"):
        word = message.split("'")[1]
        near = did_you_mean(word, VERBS)
        message = f"{word!r} is not a verb of ur, expected one of {', '.join(VERBS)}"
        help_line = f"did you mean 'ur {near}'?" if near else help_line
    else:
        message = f"{where}: {message[:1].lower()}{message[1:]}"
    _say(f"error: {message}\n  help: {help_line}")
    return 2


def report_defect(problem: Exception, words: list[str]) -> int:
    """Write down what only a developer can use, and tell where it is; returns the exit code."""
    from ur.cli.defects import write_defect

    path = write_defect(problem, words, os.environ)
    _say(
        f"error: 'ur {' '.join(words)}' failed for a reason that is a defect of ur: {type(problem).__name__}: {problem}"
    )
    _say(f"  help: please report it together with {path}" if path else "  help: please report it")
    return 2


def _say(text: str) -> None:
    try:
        sys.stderr.write(text + "\n")
    except OSError:
        return
