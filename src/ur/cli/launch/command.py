"""The command of `ur launch` for click: its help, completion, and messages about mistakes."""

from collections.abc import Iterable

import click

from ur.cli.launch.launch import launch
from ur.cli.launch.options import GROUPS, HIDDEN, BadOptionError, LaunchOption, read_launch
from ur.cli.usage import describe_values


def make_options(options: Iterable[LaunchOption], *, hidden: bool = False) -> list[click.Option]:
    """Make options of click."""
    return [
        click.Option(
            [*each.names, *([each.field] if each.field else [])],
            help=each.help,
            is_flag=each.kind == "flag",
            type=_make_type(each),
            metavar=each.metavar,
            multiple=each.multiple,
            default=each.default,
            show_default=each.default is not None,
            hidden=hidden,
        )
        for each in options
    ]


def _make_type(option: LaunchOption) -> click.IntRange | click.FloatRange | click.Choice[str] | None:
    match option.kind:
        case "number":
            return click.IntRange(option.least, option.most)
        case "seconds":
            return click.FloatRange(min=0, min_open=True, max=1e6)
        case "choice":
            return click.Choice(option.choices)
    return None


def list_groups() -> dict[str, list[str]]:
    """Return the titles of the groups, each with a name of each of its options."""
    groups = {title: [option.names[-1] for option in options] for title, options in GROUPS.items()}
    groups["Process"].append("--help")
    return groups


class LaunchCommand(click.Command):
    """A command whose arguments are read by `read_launch`."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Refuse mistakes; the command reads its arguments itself."""
        try:
            read_launch(args)
        except BadOptionError as mistake:
            raise describe_mistake(mistake, ctx) from None
        ctx.params = {"argv": tuple(args)}
        return []


def describe_mistake(mistake: BadOptionError, context: click.Context) -> click.UsageError:
    """Return the exception of click for a mistake."""
    if mistake.option is not None:
        (option,) = make_options([mistake.option])
        text = f"invalid value {mistake.problem!r} for {max(option.opts, key=len)}, expected {describe_values(option)}"
        return click.UsageError(text, context)
    if mistake.problem:
        return click.UsageError(mistake.problem, context)
    return click.NoSuchOption(mistake.name, ctx=context)


command = LaunchCommand(
    "launch",
    callback=launch,
    params=[
        *(option for options in GROUPS.values() for option in make_options(options)),
        *make_options(HIDDEN, hidden=True),
        click.Argument(["argv"], nargs=-1, metavar="[PACKAGE] FILE [ARG:=VALUE]..."),
    ],
    help=launch.__doc__,
)
