"""The verbs of `ur`: a row for each, in the order of the help. Their modules are imported on use."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import import_module
from typing import TYPE_CHECKING

from ur.cli.verbs.computer import COMPUTER
from ur.cli.verbs.driving import DRIVING
from ur.cli.verbs.launching import LAUNCHING
from ur.cli.verbs.remote import REMOTE
from ur.cli.verbs.robots import ROBOTS
from ur.cli.verbs.verb import Below, Trust, Verb
from ur.cli.verbs.writing import WRITING

if TYPE_CHECKING:
    import click

HELP = "Finds, selects and drives small ROS robots, simulated or real, and starts launch files."
EPILOG = "First drive: ur run keyboard_navigate"
VERBS = {verb.name: verb for verb in (*DRIVING, *LAUNCHING, *WRITING, *COMPUTER, *ROBOTS, *REMOTE)}


def load_verb(name: str) -> click.Command:
    """Load the command of a verb: `command` of its module."""
    command: click.Command = import_module(VERBS[name].module).command
    return command


def list_sections() -> dict[str, list[Verb]]:
    """Return the verbs of each section of the help."""
    found: dict[str, list[Verb]] = {}
    for verb in VERBS.values():
        found.setdefault(verb.section, []).append(verb)
    return found


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
