"""Documentation in programs, and the launch files and arguments that they start."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from ur.docs.repository.comments import clean_markdown
from ur.source.file import SourceFile

_COMMAND = re.compile(r"^[^#\n]*\b(?:ros)?launch\b(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE)
_FILE = re.compile(r"(?<![\w.*$}])((?:[\w./-]{0,100}/)?[\w-]+\.launch(?:\.xml)?)(?![\w.])")
_ARGUMENT = re.compile(r"(?<![\w$])(\w+):=(\"[^\"\n]*\"|'[^'\n]*'|[^\s\"';|&]+)")
_HEADING = re.compile(r"##\s*(\w+):\s?(.*)")


@dataclass(frozen=True, slots=True)
class LaunchCall:
    """A line that starts a launch file: the file's name as written, the word before it, and the arguments given."""

    file: str
    before: str
    given: tuple[tuple[str, str], ...]


def read_headings(source: SourceFile) -> Mapping[str, str]:
    """Return `##Summary: ...`, `##Overview: ...` and the `##` lines that follow each, as Markdown by heading."""
    found: dict[str, list[str]] = {}
    current: list[str] | None = None
    for line in source.text.splitlines():
        heading = _HEADING.match(line)
        if heading:
            current = found.setdefault(heading.group(1), [heading.group(2)])
        elif line.startswith("##") and current is not None:
            current.append(line.removeprefix("##").removeprefix(" "))
        else:
            current = None
    return {name: clean_markdown("\n".join(lines)) for name, lines in found.items()}


def find_starts(source: SourceFile) -> tuple[LaunchCall, ...]:
    """Return the launch files that a program names where it runs roslaunch or `ur launch`."""
    starts = []
    for command in _COMMAND.finditer(source.text):
        text = command.group().replace("\\\n", " ")
        file = _FILE.search(text)
        if file is None:
            continue
        words = text[: file.start()].split()
        given = tuple(
            (name, value.strip("\"'")) for name, value in _ARGUMENT.findall(text[file.end() :]) if "$" not in value
        )
        starts.append(LaunchCall(file.group(1), words[-1].strip("\"'") if words else "", given))
    return tuple(dict.fromkeys(starts))
