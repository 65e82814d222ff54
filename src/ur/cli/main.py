"""The `ur` command: find the verb, run it, and turn each failure into one clear line."""

from __future__ import annotations

import errno
import gc
import os
import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from ur.source.diagnostic import UserError
from ur.source.printable import OutputLost, guard_output, open_closed_streams, printable, printable_lines

if TYPE_CHECKING:
    import click


def main(arguments: Sequence[str] | None = None, load: Callable[[str], click.Command] | None = None) -> int:
    """Run `ur` with its arguments (default: those of this process) and return the exit code. Raises nothing."""
    argv = list(sys.argv[1:] if arguments is None else arguments)
    open_closed_streams()
    with guard_output():
        return _run(argv, load)


def _run(argv: list[str], load: Callable[[str], click.Command] | None) -> int:
    try:
        if argv[:1] == ["launch"] and not _wants_help(argv):
            code = _launch(argv[1:])
        elif argv[:1] == ["check"] and load is None and not any(word.startswith("-") for word in argv):
            from ur.cli.files.check_files import check_files  # without options, and so without click

            code = check_files(argv[1:])
        else:
            code = _dispatch(argv, load)
        sys.stdout.flush()
        return code
    except UserError as problem:
        from ur.source.render import render_human, shows_colour

        sys.stderr.write(render_human(problem.diagnostics, colour=shows_colour(sys.stderr)))
        return 2
    except KeyboardInterrupt:
        return 130
    except Exception as problem:
        return explain_exception(problem, argv)
    finally:
        gc.enable()  # some commands need nearly all objects until their end


def _launch(argv: list[str]) -> int:
    """Launch without click, whose import takes longer than a large launch file; it only explains mistakes."""
    from ur.cli.launch.launch import launch
    from ur.cli.launch.options import BadOptionError

    try:
        return launch(argv)
    except BadOptionError:
        return _dispatch(["launch", *argv], None)


def _dispatch(argv: list[str], load: Callable[[str], click.Command] | None) -> int:
    from ur.cli.verbs import HELP, VERBS, load_verb, replace_old_spelling, write_page
    from ur.source.render import shows_colour

    asks = argv[:1] == ["help"]
    words, verb = replace_old_spelling(argv[asks:])
    if verb:
        _print_error(f"warning: 'ur {argv[asks]}' is now 'ur {verb}'; the old spelling ends with the next release")
        argv[asks:] = words  # in place: messages about it name what was read
    if not argv or argv[0] in ("--help", "-h") or argv == ["help"]:
        sys.stdout.write(write_page(colour=shows_colour(sys.stdout)))
        return 0
    if argv[0] == "help" or (argv[0] in VERBS and _wants_help(argv)):
        from ur.cli.help import show_help

        show_help(argv[1:] if argv[0] == "help" else argv)
        return 0
    import click

    group = click.Group("ur", params=[_version_option()], help=HELP)
    if argv[0] in VERBS:
        group.add_command((load or load_verb)(argv[0]), argv[0])
    try:
        with group.make_context("ur", argv, color=None if shows_colour(sys.stdout) else False) as context:
            result = group.invoke(context)
    except click.exceptions.Exit as end:
        return end.exit_code
    return result if isinstance(result, int) else 0


def _wants_help(argv: list[str]) -> bool:
    # Arguments after a program, or after a command of another computer, belong to that.
    end = 2 if argv[0] == "run" else len(argv)
    return any(word in ("--help", "-h") for word in argv[1:end])


def _version_option() -> click.Option:
    import click

    def show(ctx: click.Context, _param: click.Parameter, value: bool) -> None:
        if value:
            from importlib.metadata import version

            from ur.source.project import DISTRIBUTION, describe_origin

            click.echo(f"ur {version(DISTRIBUTION)} ({describe_origin()})")
            ctx.exit(0)

    return click.Option(
        ["--version"], is_flag=True, expose_value=False, is_eager=True, callback=show, help="Print the version."
    )


_REFUSALS = {  # errors of the system, not of this program
    errno.EACCES: "list the permissions of all folders above it: namei -l {}",
    errno.EPERM: "list the permissions of all folders above it: namei -l {}",
    errno.ENAMETOOLONG: "choose a shorter name",
    errno.EROFS: "choose a folder of a file system that can be written",
    errno.ENOSPC: "make room on the disk (df -h), then run this again",
    errno.EDQUOT: "make room below your quota, then run this again",
}


def explain_exception(problem: Exception, argv: list[str]) -> int:
    """Report a wrong command line, or that output, the current folder or a file is unusable, in one line.

    Other exceptions are internal errors.

    Returns the exit code.
    """
    import click

    if isinstance(problem, click.Abort):
        return 130
    if isinstance(problem, click.UsageError):
        from ur.cli.usage import describe_usage_error

        _print_error(describe_usage_error(problem, argv))
        return 2
    if isinstance(problem, click.ClickException):
        _print_error(f"error: {printable_lines(problem.format_message())}")
        return 2
    if isinstance(problem, OutputLost):
        if isinstance(problem.reason, BrokenPipeError):
            return 141
        reason = (problem.reason.strerror or str(problem.reason)).lower()
        _print_error(f"error: standard output cannot be written: {reason}")
        _print_error("  help: is the disk full, or standard output closed? then run this again")
        return 2
    if isinstance(problem, OSError) and not _has_folder():
        _print_error("error: the current folder does not exist any more, expected one to work in")
        _print_error("  help: cd to another folder, then run this again")
        return 2
    if isinstance(problem, OSError) and problem.errno in _REFUSALS and isinstance(problem.filename, (str, bytes)):
        from shlex import quote

        name = printable(os.fsdecode(problem.filename))
        _print_error(f"error: '{name}' cannot be used: {(problem.strerror or str(problem)).lower()}")
        _print_error(f"  help: {_REFUSALS[problem.errno].format(quote(name))}")
        return 2
    return report_defect(problem, argv)


def _has_folder() -> bool:
    try:
        os.getcwd()  # noqa: PTH109 - asks the system, and nothing else
    except OSError:
        return False
    return True


def report_defect(problem: Exception, argv: list[str]) -> int:
    """Write the traceback to a file, and print its path; return the exit code."""
    from pathlib import Path

    from ur.source.crash import write_crash_report
    from ur.source.user_folders import user_folder

    folder = Path(user_folder("XDG_STATE_HOME", os.environ), "ubiquity_launches")
    path = write_crash_report(problem, "ur", [folder], argv)
    _print_error(
        f"error: internal error in 'ur {printable(' '.join(argv))}': "
        f"{type(problem).__name__}: {printable(str(problem))}"
    )
    _print_error(f"  help: please report it with the file {path}" if path else "  help: please report it")
    return 2


def _print_error(text: str) -> None:
    try:
        sys.stderr.write(text + "\n")
    except OSError:
        return
