"""Rows of verbs: each is complete, and agrees with the module that it names."""

import subprocess
import sys

import click
import pytest

from ur.cli.verbs import VERBS, list_sections, load_verb


@pytest.mark.parametrize("name", VERBS)
def test_commands_below_a_verb_have_rows_in_their_order(name: str) -> None:
    command = load_verb(name)
    below = list(command.commands) if isinstance(command, click.Group) else []
    assert sorted(VERBS[name].below) == sorted(below)


def test_verbs_of_a_section_stand_together() -> None:
    assert [verb for verbs in list_sections().values() for verb in verbs] == list(VERBS.values())


def test_names_of_verbs_are_known_without_click() -> None:
    script = "import sys, ur.cli.verbs; sys.exit('click' in sys.modules)"
    assert subprocess.run([sys.executable, "-I", "-c", script], timeout=60, check=False).returncode == 0
