"""Keys of YAML files: the one at a place, and those of other files with their documentation and values."""

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import yaml

from ur.source.file import SourceFile, Span
from ur.source.foreign.yaml_text import compose_yaml

_MOST_VALUES = 12
_LONGEST_VALUE = 60
_IN_KEY = re.compile(r"[\w./~-]")
_KEY = re.compile(r"""^(?P<indent> *)(?P<dashes>(?:- +)*)(?P<key>[\w./~-]+|"[^"]*"|'[^']*')[ ]*:(?=[ \n]|$)""")


@dataclass(slots=True)
class KnownKey:
    """A key of other files: its documentation and values."""

    document: str = ""
    values: dict[str, None] = field(default_factory=dict)
    nested: bool = False


def find_key(source: SourceFile, offset: int) -> tuple[tuple[str, ...], Span] | None:
    """The key at an offset of a YAML file, with the keys around it."""
    text = source.text
    start, end = offset, offset
    while start > 0 and _IN_KEY.match(text[start - 1]):
        start -= 1
    while end < len(text) and _IN_KEY.match(text[end]):
        end += 1
    if start == end or not re.match(r"[\"']? *:(?=[ \n]|\Z)", text[end:]):
        return None
    parents, _ = find_parents(text, start)
    return parents, Span(source, start, end)


def find_parents(text: str, offset: int) -> tuple[tuple[str, ...], str]:
    """The keys around an offset, outermost first, and the text before it: of its line, or of its braces."""
    start = text.rfind("\n", 0, offset) + 1
    line = text[start:offset]
    indent = len(line) - len(line.lstrip(" "))
    column = indent + 1 if line[indent:].startswith("- ") else indent
    parents: list[str] = []
    for above in reversed(text[:start].splitlines()):
        found = _KEY.match(above)
        if found is None:
            continue
        place = found.start("key")
        if place < column:
            parents.insert(0, found["key"].strip("\"'"))
        if place <= column:
            # Keys of an item of a list belong to a key that may stand below its dash.
            column = len(found["indent"]) + 1 if found["dashes"] else min(place, column)
    key = _KEY.match(line)
    opened: list[int] = []
    for index, letter in enumerate(line):
        if letter == "{":
            opened.append(index)
        elif letter == "}" and opened:
            opened.pop()
    for index in opened:
        name = re.search(r"([\w./~-]{1,200}) {0,50}: {0,50}\[? {0,50}\Z", line[:index])
        if name is not None:
            parents.append(name[1])
    return tuple(parents), line[opened[-1] :] if opened else line if key is None else line[key.start("key") :]


def plain_parents(parents: tuple[str, ...]) -> tuple[str, ...]:
    """The keys around a key as other files have them: a variant has the keys of its base."""
    return parents[2:] if parents[:1] == ("variants",) else parents


def comment_on_line(lines: Sequence[str], number: int) -> str:
    """The comment behind a line of YAML, counted from 0, else the one above its paragraph; not that of the file."""
    behind = lines[number].partition(" # ")[2].strip() if number < len(lines) else ""
    if behind:
        return behind
    above = number - 1
    while above >= 0 and lines[above].strip() and not lines[above].lstrip().startswith("#"):
        above -= 1
    block: list[str] = []
    while above >= 0 and lines[above].lstrip().startswith("#"):
        block.insert(0, lines[above].lstrip("# ").strip())
        above -= 1
    return " ".join(block) if above >= 0 else ""


def survey_keys(text: str, known: dict[tuple[str, ...], dict[str, KnownKey]]) -> None:
    """Add the keys of a YAML text to those that are known, by the keys around them."""
    with suppress(yaml.YAMLError, ValueError, RecursionError):
        node = compose_yaml(text)
        if node is not None:
            _survey_node(node, (), text.splitlines(), known)


def _survey_node(
    node: yaml.Node, parents: tuple[str, ...], lines: Sequence[str], known: dict[tuple[str, ...], dict[str, KnownKey]]
) -> None:
    if isinstance(node, yaml.SequenceNode):
        for item in node.value:
            if isinstance(item, yaml.MappingNode):
                _survey_node(item, parents, lines, known)
    if not isinstance(node, yaml.MappingNode):
        return
    keys = known.setdefault(plain_parents(parents), {}) if parents[:1] != ("variants",) or len(parents) > 1 else {}
    for key, value in node.value:
        name = str(key.value)
        found = keys.setdefault(name, KnownKey())
        if not found.document and not lines[key.start_mark.line][: key.start_mark.column].strip(" -"):
            found.document = comment_on_line(lines, key.start_mark.line)
        if isinstance(value, yaml.ScalarNode):
            if len(value.value) <= _LONGEST_VALUE and len(found.values) < _MOST_VALUES and "\n" not in value.value:
                found.values[value.value] = None
        else:
            found.nested = isinstance(value, yaml.MappingNode) or found.nested
            _survey_node(value, (*parents, name), lines, known)
