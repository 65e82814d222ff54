"""The verbs of `ur`: a row for each, in the order of the help. Their modules are imported on use."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib import import_module
from typing import TYPE_CHECKING

from ur.cli.verbs.computer import COMPUTER
from ur.cli.verbs.driving import DRIVING
from ur.cli.verbs.launching import LAUNCHING
from ur.cli.verbs.robots import ROBOTS
from ur.cli.verbs.verb import PLUMBING, Below, Trust, Verb
from ur.cli.verbs.writing import WRITING
from ur.source.ansi import BOLD, CYAN, paint, strip_styles

if TYPE_CHECKING:
    import click

HELP = "Finds, selects and drives small ROS robots, and starts launch files."
VERBS = {verb.name: verb for verb in (*DRIVING, *LAUNCHING, *WRITING, *COMPUTER, *ROBOTS)}
OLD_SPELLINGS = {  # of version 0.1: the present one, and options that have another name; to be removed after 0.2
    "unmount": ("mount --undo", {}),
    "package": ("check --package", {"--write": "--fix"}),
    "debian": ("setup debian", {}),
    "x": ("shell -X", {}),
    "wifi": ("doctor --wireless", {}),
}


def load_verb(name: str) -> click.Command:
    """Load the command of a verb: `command` of its module."""
    command: click.Command = import_module(VERBS[name].module).command
    return command


def replace_old_spelling(argv: Sequence[str]) -> tuple[list[str], str]:
    """Return a command line in its present spelling, and that of its verb; '' if it was not old."""
    if not argv or argv[0] not in OLD_SPELLINGS:
        return list(argv), ""
    verb, options = OLD_SPELLINGS[argv[0]]
    return [*verb.split(), *(options.get(word, word) for word in argv[1:])], verb


def list_sections() -> dict[str, list[Verb]]:
    """Return the verbs of each section."""
    found: dict[str, list[Verb]] = {}
    for verb in VERBS.values():
        found.setdefault(verb.section, []).append(verb)
    return found


def write_page(*, colour: bool) -> str:
    """Return the page of `ur`: the verbs of each section, at most 50 lines of 80 columns."""
    lines = [HELP, "Usage: ur VERB [ARGS]; 'ur help VERB' describes one.", "First drive: ur run keyboard_navigate"]
    sections = {title: verbs for title, verbs in list_sections().items() if title != PLUMBING}
    width = max(len(verb.name) for verbs in sections.values() for verb in verbs)
    for title, verbs in sections.items():
        lines += ["", paint(title, BOLD)]
        lines += [f"  {paint(verb.name.ljust(width), CYAN)}  {verb.summary}" for verb in verbs]
    page = "\n".join(lines) + "\n"
    return page if colour else strip_styles(page)


def list_pages() -> Iterator[tuple[str, Verb | Below]]:
    """Yield the declaration of each verb, and of each command below one (`maps show`)."""
    for verb in VERBS.values():
        yield verb.name, verb
        yield from ((f"{verb.name} {name}", below) for name, below in verb.below.items())


def list_trust() -> Iterator[tuple[str, Trust]]:
    """Yield the trust of each verb, and of each command below one that declares its own."""
    for verb in VERBS.values():
        yield verb.name, verb.trust
        yield from ((f"{verb.name} {name}", below.trust) for name, below in verb.below.items() if below.trust)
