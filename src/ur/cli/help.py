"""Help pages. Imported only to show one, because importing rich is slow."""

import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from textwrap import fill

import click
from rich_click import RichCommand, RichContext, RichGroup, RichHelpConfiguration
from rich_click.utils import OptionGroupDict

from ur.cli.verbs import VERBS, load_verb
from ur.cli.verbs.verb import Below, Verb
from ur.source.diagnostic import user_error
from ur.source.render import shows_colour
from ur.source.suggest import did_you_mean


def show_help(argv: list[str]) -> None:
    """Print the page of one verb (`robot`, `robot setup`) or of a program (`run NAME`, `NAME`).

    Raises UserError when there is none.
    """
    if argv[0] not in VERBS or (argv[0] == "run" and len(argv) > 1 and not argv[1].startswith("-")):
        _show_program(argv[1] if argv[0] == "run" else argv[0], known_verb=argv[0] == "run")
        return
    about: Verb | Below = VERBS[argv[0]]
    verb, path = load_verb(argv[0]), f"ur {argv[0]}"
    for name in argv[1:]:
        if isinstance(verb, click.Group) and name in verb.commands:
            about, verb, path = VERBS[argv[0]].below[name], verb.commands[name], f"{path} {name}"
    if isinstance(verb, click.Group):
        group = _InOrder(
            name=verb.name,
            help=verb.help,
            params=list(verb.params),
            options_metavar="[OPTIONS]" if verb.params else "",
            subcommand_metavar="[VERB [ARGS]]" if verb.invoke_without_command else "VERB [ARGS]",
        )
        for each in verb.commands.values():
            group.add_command(RichCommand(name=each.name, help=each.help, short_help=each.short_help))
        _print(group, path, about)
        return
    page = RichCommand(
        name=verb.name,
        callback=verb.callback,
        params=list(verb.params),
        help=verb.help,
        epilog=verb.epilog,
        options_metavar="[OPTIONS]" if any(isinstance(each, click.Option) for each in verb.params) else "",
    )
    _print(page, path, about, tuple(_list_arguments(verb, about)))


def _show_program(name: str, *, known_verb: bool) -> None:
    from ur.cli.launch.program_help import describe_program
    from ur.request.environment import add_own_package
    from ur.request.programs import PACKAGE, choose_program, index_programs

    index = index_programs(PACKAGE, add_own_package(os.environ))
    names = {each.name for each in index.programs}
    if known_verb or name.rpartition("/")[2].removeprefix("ur_") in names:
        click.echo(describe_program(choose_program(index.programs, name, index.problem), os.environ), nl=False)
        return
    near = did_you_mean(name, (*VERBS, *names))
    raise user_error(
        f"unknown command {name!r}, expected a command of ur or a program",
        rule="unknown-verb",
        help=f"did you mean 'ur help {near}'?" if near else "'ur help' lists the verbs, 'ur list' the programs",
        subject=name,
    )


def _list_arguments(verb: click.Command, about: Verb | Below) -> Iterator[tuple[str, str]]:
    """Yield the metavariable and the description of each positional argument."""
    positional = [each for each in verb.params if isinstance(each, click.Argument)]
    context = click.Context(verb)
    for each, text in zip(positional, about.descriptions, strict=True):
        yield each.make_metavar(context), text


class _InOrder(RichGroup):
    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        return list(self.commands)


def _print(page: click.Command, name: str, about: Verb | Below, arguments: Sequence[tuple[str, str]] = ()) -> None:
    groups: list[OptionGroupDict] = []
    if name == "ur launch":
        from ur.cli.launch.command import list_groups

        groups = [{"name": title, "options": options} for title, options in list_groups().items()]
    frame = "ROUNDED" if os.environ.get("TERM") != "dumb" else "BLANK"
    settings = RichHelpConfiguration(
        style_options_panel_box=frame,
        style_commands_panel_box=frame,
        option_groups={"ur launch": groups} if name == "ur launch" else {},
    )
    context = RichContext(page, info_name=name, rich_help_config=settings)
    click.echo(page.get_help(context), color=None if shows_colour(sys.stdout) else False)
    click.echo("".join(_write_end(arguments, about.examples)), nl=False)


def _write_end(arguments: Sequence[tuple[str, str]], examples: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Yield arguments with their descriptions, then examples, each preceded by its meaning."""
    width = min(100, shutil.get_terminal_size().columns) - 1
    if arguments:
        yield " Arguments:\n"
    for written, text in arguments:
        yield f"   {written}\n"
        yield fill(text, width, initial_indent=" " * 7, subsequent_indent=" " * 7, break_on_hyphens=False) + "\n"
    yield " Examples:\n"
    for command, meaning in examples:
        yield f"   # {meaning}\n   {command}\n"
