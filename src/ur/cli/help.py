"""Help pages. Only imported to show one: rich is expensive."""

from __future__ import annotations

from typing import Any

import click
from rich_click import RichCommand, RichContext, RichGroup, RichHelpConfiguration
from rich_click.utils import CommandGroupDict

from ur.cli.main import EPILOG, HELP, VERBS, load_verb
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean

# What people come for, in the order in which they come for it. Each verb stands in one of them; a test looks.
SECTIONS = {
    "Drive": ("run", "list", "use"),
    "Launch": ("launch", "ps", "attach", "logs", "restart", "wait", "stop"),
    "Write": ("check", "new", "package", "format", "find", "docs", "graph", "explain"),
    "This computer": ("setup", "completion", "env"),
    "Robots": (
        *("robots", "robot", "image", "doctor", "wifi", "shell", "x", "boot"),
        *("sync", "build", "mount", "unmount"),
    ),
}


def show_help(words: list[str]) -> None:
    """Print the page of `ur`, or of one verb (`robot`, `robot setup`). Raises UserError when there is none."""
    if not words:
        _print(_overview(), "ur")
        return
    if words[0] not in VERBS:
        near = did_you_mean(words[0], VERBS)
        raise UserError(
            error(
                f"{words[0]!r} is not a verb of ur, expected one of {', '.join(VERBS)}",
                rule="unknown-verb",
                help=f"did you mean 'ur {near}'?" if near else None,
            )
        )
    verb, path = load_verb(words[0]), f"ur {words[0]}"
    for word in words[1:]:
        if isinstance(verb, click.Group) and word in verb.commands:
            verb, path = verb.commands[word], f"{path} {word}"
    if isinstance(verb, click.Group):
        group = _InOrder(name=verb.name, help=verb.help, options_metavar="", subcommand_metavar="VERB [ARGS]")
        for each in verb.commands.values():
            group.add_command(RichCommand(name=each.name, help=each.help, short_help=each.short_help))
        _print(group, path)
        return
    page = RichCommand(
        name=verb.name,
        callback=verb.callback,
        params=list(verb.params),
        help=verb.help,
        epilog=verb.epilog,
        options_metavar="[OPTIONS]" if any(isinstance(each, click.Option) for each in verb.params) else "",
    )
    _print(page, path)


class _InOrder(RichGroup):
    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        return list(self.commands)


def _overview() -> RichGroup:
    group = _InOrder(
        name="ur", help=HELP, epilog=EPILOG, options_metavar="[--version]", subcommand_metavar="VERB [ARGS]"
    )
    for name, (_, summary) in VERBS.items():
        group.add_command(RichCommand(name=name, help=summary, short_help=summary))
    group.params.append(click.Option(["--version"], is_flag=True, help="Print the version."))
    return group


def _print(page: Any, name: str) -> None:
    sections: list[CommandGroupDict] = [{"name": title, "commands": list(verbs)} for title, verbs in SECTIONS.items()]
    settings = RichHelpConfiguration(command_groups={"ur": sections} if name == "ur" else {})
    context = RichContext(page, info_name=name, rich_help_config=settings)
    click.echo(page.get_help(context))
