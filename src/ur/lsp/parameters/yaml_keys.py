"""Keys of YAML files, known from files of their kind and from the programs that read them.

Keys and values of a YAML file are those of files of its kind: base, world and map files of the launch library, and
files beside it. A comment at a key there is its documentation. The keys of a parameter file are also the parameters
of the nodes that load it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import yaml

from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.parameters.documents import comment_on_line, know_parameters
from ur.lsp.parameters.programs import NodeProgram, find_loaders, node_of
from ur.lsp.workspace import Workspace
from ur.source.file import SourceFile, Span
from ur.source.foreign.yaml_text import compose_yaml

_LIBRARY = "ubiquity_launches"
_MOST_FILES = 40
_MOST_TEXT = 200_000  # characters of a file
_MOST_VALUES = 12
_LONGEST_VALUE = 60
_IN_KEY = re.compile(r"[\w./~-]")
_KEY = re.compile(r"""^(?P<indent> *)(?P<dashes>(?:- +)*)(?P<key>[\w./~-]+|"[^"]*"|'[^']*')[ ]*:(?=[ \n]|$)""")
_OF_WORLD = re.compile(r"^(floor_plan|boxes|obstacles|fiducials|drops):", re.MULTILINE)
_OF_MAP = re.compile(r"^(image|resolution):", re.MULTILINE)


@dataclass(slots=True)
class KnownKey:
    """A key of other files: its documentation and values."""

    document: str = ""
    values: dict[str, None] = field(default_factory=dict)
    nested: bool = False


def is_yaml(path: str) -> bool:
    """Return whether a path is that of a YAML file."""
    return path.endswith((".yaml", ".yml"))


def know_keys(workspace: Workspace, path: str, text: str) -> dict[tuple[str, ...], dict[str, KnownKey]]:
    """The keys of files of a kind, by the keys around them."""
    known: dict[tuple[str, ...], dict[str, KnownKey]] = {}
    for source in _samples(workspace, path, text):
        _survey(source, known)
    programs = programs_of_yaml(workspace, path)
    for parameter in know_parameters(programs, workspace).values():
        *parents, name = parameter.name.split("/")
        found = known.setdefault((*parents,), {}).setdefault(name, KnownKey())
        found.document = found.document or parameter.document
        found.values.update(dict.fromkeys(parameter.values))
    return known


def programs_of_yaml(workspace: Workspace, path: str) -> list[NodeProgram]:
    """The programs of the nodes that load a YAML file as their private parameters."""
    nodes = (node_of(param.name, plan) for plan, param in find_loaders(path, workspace))
    return list(dict.fromkeys(NodeProgram(node.package, node.type) for node in nodes if node is not None))


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
    return _in_braces(parents, line)


def _in_braces(parents: list[str], line: str) -> tuple[tuple[str, ...], str]:
    key = _KEY.match(line)
    opened: list[int] = []
    for index, letter in enumerate(line):
        if letter == "{":
            opened.append(index)
        elif letter == "}" and opened:
            opened.pop()
    for index in opened:
        name = re.search(r"([\w./~-]+) *: *\[? *\Z", line[:index])
        if name is not None:
            parents.append(name[1])
    return tuple(parents), line[opened[-1] :] if opened else line if key is None else line[key.start("key") :]


def plain_parents(parents: tuple[str, ...]) -> tuple[str, ...]:
    """The keys around a key as other files have them: a variant has the keys of its base."""
    return parents[2:] if parents[:1] == ("variants",) else parents


def _samples(workspace: Workspace, path: str, text: str) -> Iterator[str]:
    """The texts of other files of the same kind."""
    folder = Path(path).parent
    with suppress(PackageNotFound):
        library = Path(workspace.world.find_package(_LIBRARY))
        if Path(path).name == "base.yaml":
            yield from _read(workspace, path, sorted(library.glob("bases/*/base.yaml")))
        elif (
            re.search(r"^(floor_plan|boxes|obstacles|fiducials|drops):", text, re.MULTILINE) or folder.name == "worlds"
        ):
            yield from _read(workspace, path, sorted(library.glob("n_simulator/worlds/*.yaml")))
        elif folder.name == "maps" or _OF_MAP.search(text):
            yield _MAP
    if Path(path).name == "base.yaml":
        yield from _read(workspace, path, sorted(folder.parent.glob("*/base.yaml")))
    yield from _read(workspace, path, sorted({*folder.glob("*.yaml"), *folder.glob("*.yml")}))


def _read(workspace: Workspace, path: str, files: Sequence[Path]) -> Iterator[str]:
    for each in files[:_MOST_FILES]:
        if str(each) != path:
            with suppress(OSError):
                yield workspace.source(str(each)).text[:_MOST_TEXT]


_MAP = """image: map.pgm # relative to this file
resolution: 0.05 # m per pixel
origin: [0.0, 0.0, 0.0] # x, y (m) and yaw of the lower left corner
negate: 0 # 1: white is occupied
occupied_thresh: 0.65 # probability from which a pixel is occupied
free_thresh: 0.196 # probability up to which a pixel is free
mode: trinary # or scale, raw
"""


def _survey(text: str, known: dict[tuple[str, ...], dict[str, KnownKey]]) -> None:
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
