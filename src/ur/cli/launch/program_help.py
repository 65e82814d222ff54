"""The help page of a program: its overview, the arguments of its launch file, and examples."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Iterator, Mapping, Sequence
from textwrap import fill, wrap
from typing import TYPE_CHECKING

from ur.request.programs import Program, find_launch_file, read_program_arguments
from ur.source.foreign.files import read_text
from ur.source.printable import printable
from ur.source.render import shows_colour

if TYPE_CHECKING:
    from ur.launchfile.query.arguments import ArgumentSpec

_WIDEST = 100
_INDENT = "      "
_CODE = re.compile(r"`([^`]*)`")
_EXAMPLES = re.compile(r"`(\w+:=[^`]+)`")


def describe_program(program: Program, environment: Mapping[str, str]) -> str:
    """Write the help page of a program, for a terminal as wide as this one.

    Raises UserError when its launch file cannot be read.
    """
    from ur.docs.repository.comments import read_headings
    from ur.source.file import SourceFile

    width = min(_WIDEST, shutil.get_terminal_size().columns)
    text = read_text(program.path)
    headings = read_headings(SourceFile(str(program.path), text))
    overview = headings.get("Overview", "")
    path = find_launch_file(program)
    lines = [f"Usage: ur run {program.name} [OPTIONS] [NAME:=VALUE]...", ""]
    lines += [*_prose(program.summary or program.name, width), ""]
    for paragraph in re.split(r"\n\s*\n", overview):
        if paragraph.strip() and not paragraph.startswith("Arguments are those of"):
            lines += [*_prose(paragraph, width), ""]
    if path is None:
        lines += ["It starts no launch file of its package: its arguments are its own.", ""]
        return _finish(lines)
    lines += [_heading(f"Arguments of {path.name}, with their defaults:")]
    arguments = read_program_arguments(path, environment)
    for each in arguments:
        lines += _argument(each, environment, width)
    lines += ["", _heading("Options:")]
    lines += [
        *_prose("Those of 'ur launch', for example --detach, --json, --dry-run; 'ur help launch' has all.", width)
    ]
    lines += ["", _heading("Examples:"), f"  ur run {program.name}"]
    found = [each for each in _EXAMPLES.findall(overview) if each != "NAME:=VALUE"]
    found = found or [f"{each.name}:={each.default or 'VALUE'}" for each in arguments[:1]]
    lines += [f"  ur run {program.name} {' '.join(each.split())}" for each in found]
    return _finish(lines)


def _argument(each: ArgumentSpec, environment: Mapping[str, str], width: int) -> Iterator[str]:
    value = "VALUE" if each.default is None else printable(each.default)
    yield f"  {each.name}:={value}" + ("  (required)" if each.default is None else "")
    text = _plain(each.doc)
    values = _values(each, environment)
    yield from wrap(
        printable(f"{text} Values: {', '.join(values)}." if values else text),
        width,
        initial_indent=_INDENT,
        subsequent_indent=_INDENT,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _values(each: ArgumentSpec, environment: Mapping[str, str]) -> list[str]:
    from ur.complete.names import list_values

    found = [value.text for value in list_values(each.name, {}, environment)]
    if not found and (each.default or "").lower() in ("true", "false"):
        return ["true", "false"]
    if each.name == "world" and found:
        found.append("the path of a world file")
    return found


def _prose(text: str, width: int) -> list[str]:
    flat = printable(_plain(text))
    return fill(
        flat, width, initial_indent="  ", subsequent_indent="  ", break_long_words=False, break_on_hyphens=False
    ).splitlines()


def _plain(text: str) -> str:
    """Convert Markdown to plain text: code of several words gets quotes, other code none."""
    return " ".join(_CODE.sub(lambda found: f"'{found[1]}'" if " " in found[1] else found[1], text).split())


def _heading(text: str) -> str:
    return f"\x1b[1m{text}\x1b[0m" if shows_colour(sys.stdout) else text


def _finish(lines: Sequence[str]) -> str:
    return "\n".join(lines).rstrip() + "\n"
