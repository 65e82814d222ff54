"""Each option of each command is in a test and on a page that is written by hand."""

import re
from collections.abc import Iterator
from pathlib import Path

import click
from tests.cli.wrong_inputs import list_commands

ROOT = Path(__file__).resolve().parents[2]
NOT_A_TEST = ("messages.txt", "verbs.md", "CHANGELOG.md")  # made of the options, or history


def read_words(*paths: Path) -> frozenset[str]:
    """Every option in files, and in the files of folders."""
    found: set[str] = set()
    for path in paths:
        for each in path.rglob("*") if path.is_dir() else [path]:
            if each.suffix in (".py", ".md", ".txt", ".tsv", ".bash", "") and each.name not in NOT_A_TEST:
                text = each.read_text(encoding="utf-8", errors="replace") if each.is_file() else ""
                found.update(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", text))
    return frozenset(found)


def list_options() -> Iterator[tuple[str, click.Option]]:
    for words, command in list_commands():
        for each in command.params:
            if isinstance(each, click.Option) and not each.hidden:
                yield " ".join(words), each


def test_each_option_is_in_a_test_and_on_a_page() -> None:
    options = [(command, {*each.opts, *each.secondary_opts}) for command, each in list_options()]
    assert len(options) > 200
    tests = read_words(ROOT / "tests")
    assert [each for each in options if not each[1] & tests] == []
    pages = read_words(ROOT / "docs", ROOT / "README.md")
    assert [each for each in options if not each[1] & pages] == []
