"""Candidates in files beside launch files: keys and values of YAML files, and headings of programs.

Keys and values of a YAML file are those of files of its kind: base, world and map files of the launch library, and
files beside it. A comment after a key there is its documentation.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import yaml

from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.completion.candidate import Candidate
from ur.lsp.workspace import Workspace
from ur.source.foreign.yaml_text import compose_yaml

_LIBRARY = "ubiquity_launches"
_MOST_FILES = 40
_MOST_TEXT = 200_000  # characters of a file
_MOST_VALUES = 12
_LONGEST_VALUE = 60
_KEY = re.compile(r"""^(?P<indent> *)(?P<dashes>(?:- +)*)(?P<key>[\w./~-]+|"[^"]*"|'[^']*')[ ]*:(?=[ \n]|$)""")
_OF_WORLD = re.compile(r"^(floor_plan|boxes|obstacles|fiducials|drops):", re.MULTILINE)
_OF_MAP = re.compile(r"^(image|resolution):", re.MULTILINE)
_HEADINGS = {
    "Summary": "One line, which `ur list` and the documentation show.",
    "Overview": "Markdown, which goes on in the lines below that begin with `## `.",
    "Publishes": "Topics that the node publishes, each in backticks.",
    "Subscribes": "Topics that the node subscribes to, each in backticks.",
    "Offers": "Services that the node offers, each in backticks.",
    "Calls": "Services that the node calls, each in backticks.",
    "Actions": "Actions that the node serves, each in backticks.",
    "Uses": "Actions that the node sends goals to, each in backticks.",
    "Python": "Needed Python packages: `lock file: modules: name and size`.",
    "Debian": "Needed Debian packages: `private parameter: packages | other packages: name and size`.",
    "File": "A needed file: `private parameter of its path: private parameter of the condition: how to make it`.",
}


@dataclass(slots=True)
class _Known:
    """A key of other files: its documentation and values."""

    document: str = ""
    values: dict[str, None] = field(default_factory=dict)
    nested: bool = False


def is_yaml(path: str) -> bool:
    """Return whether a path is that of a YAML file."""
    return path.endswith((".yaml", ".yml"))


def complete_heading(text: str, offset: int) -> list[Candidate]:
    """Candidates for `##Heading:` lines of a program."""
    start = text.rfind("\n", 0, offset) + 1
    typed = text[start:offset]
    if not text.startswith("#!") or start == 0 or not re.fullmatch(r"#{1,2}\w*", typed):
        return []
    end = offset + len(re.match(r"\w*:?", text[offset:])[0])  # type: ignore[index]
    given = {each for each in _HEADINGS if re.search(rf"^##{each}:", text, re.MULTILINE)}
    return [
        Candidate(f"##{name}:", "attribute", f"##{name}: ", start, end, "", document)
        for name, document in _HEADINGS.items()
        if name not in given and f"##{name}:".startswith(typed)
    ]


def complete_yaml(workspace: Workspace, path: str, text: str, offset: int) -> list[Candidate]:
    """The candidates at a place of a YAML file: keys at the start of an item, values behind `key: `."""
    parents, before = find_parents(text, offset)
    value = re.search(r"([\w./~-]+) *: +([^{}\[\],#]*)\Z", before)
    typed = value[2] if value is not None else re.search(r"[\w./~-]*\Z", before)[0]  # type: ignore[index]
    start = offset - len(typed)
    rest = re.match(r"[\w./~-]*", text[offset:])
    end = offset + (len(rest[0]) if rest is not None else 0)
    known: dict[tuple[str, ...], dict[str, _Known]] = {}
    for source in _samples(workspace, path, text):
        _survey(source, known)
    if value is not None:
        here = known.get(_plain(parents), {}).get(value[1])
        values = here.values if here is not None else {}
        return [Candidate(each, "value", each, start, end) for each in values if each.startswith(typed)]
    if before.strip(" -") != typed and not re.search(r"[{,] *[\w./~-]*\Z", before):
        return []
    colon = "" if text[end : end + 1] == ":" else ":"
    return [
        Candidate(
            name, "attribute", f"{name}{colon}{' ' if colon and not each.nested else ''}", start, end, "", each.document
        )
        for name, each in known.get(_plain(parents), {}).items()
        if name.startswith(typed) and name != text[start:end]
    ]


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


def _plain(parents: tuple[str, ...]) -> tuple[str, ...]:
    # A variant has the keys of its base.
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


def _survey(text: str, known: dict[tuple[str, ...], dict[str, _Known]]) -> None:
    with suppress(yaml.YAMLError, ValueError, RecursionError):
        node = compose_yaml(text)
        if node is not None:
            _survey_node(node, (), text.splitlines(), known)


def _survey_node(
    node: yaml.Node, parents: tuple[str, ...], lines: Sequence[str], known: dict[tuple[str, ...], dict[str, _Known]]
) -> None:
    if isinstance(node, yaml.SequenceNode):
        for item in node.value:
            if isinstance(item, yaml.MappingNode):
                _survey_node(item, parents, lines, known)
    if not isinstance(node, yaml.MappingNode):
        return
    keys = known.setdefault(_plain(parents), {}) if parents[:1] != ("variants",) or len(parents) > 1 else {}
    for key, value in node.value:
        name = str(key.value)
        found = keys.setdefault(name, _Known())
        line = lines[key.start_mark.line]
        comment = line.partition(" # ")[2] if not line[: key.start_mark.column].strip(" -") else ""
        found.document = found.document or comment.strip()
        if isinstance(value, yaml.ScalarNode):
            if len(value.value) <= _LONGEST_VALUE and len(found.values) < _MOST_VALUES and "\n" not in value.value:
                found.values[value.value] = None
        else:
            found.nested = isinstance(value, yaml.MappingNode) or found.nested
            _survey_node(value, (*parents, name), lines, known)
