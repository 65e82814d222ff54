"""YAML files written by users: read with positions, checked key by key, with suggestions for misspelt keys."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NoReturn, TypeGuard

import yaml

from ur.source.diagnostic import user_error, user_error_about
from ur.source.file import SourceFile, Span
from ur.source.foreign.yaml_text import compose_yaml, construct_yaml
from ur.source.read import read_source
from ur.source.suggest import did_you_mean

_REQUIRED: object = object()
_NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?")


def read_section(path: str | Path, what: str, *, piped: bool = True) -> Section:
    """Read the top-level mapping of a YAML file. `what` names the kind of file in errors: "a base file".

    `piped` as in read_source: not for a path that another file names. Raises UserError with file, line and column:
    unreadable, not YAML, or not a mapping.
    """
    return parse_section(read_source(path, expected=what, piped=piped), what)


def parse_section(file: SourceFile, what: str) -> Section:
    """Parse the top-level mapping of a text, as `read_section` does."""
    try:
        node = compose_yaml(file.text)
    except yaml.MarkedYAMLError as problem:
        mark = problem.problem_mark or problem.context_mark
        start = min(_offset(file, mark), len(file.text))
        text = " ".join(part for part in (problem.context, problem.problem) if part)
        raise user_error(
            f"not valid YAML, expected {what}: {text}", Span(file, start, start + 1), rule="bad-yaml"
        ) from None
    except yaml.YAMLError as problem:
        raise user_error_about(file.path, f"not valid YAML, expected {what}: {problem}", rule="bad-yaml") from None
    if not isinstance(node, yaml.MappingNode):
        found = "an empty file" if node is None else f"a {_kind(node)}"
        raise user_error(f"{found}, expected {what}: a mapping of names to values", Span(file, 0, 1), rule="bad-yaml")
    return Section(file, node, what)


class Section:
    """A mapping that is being read.

    Every accessor names the expected value; `finish` refuses keys that were not read.
    """

    def __init__(self, file: SourceFile, node: yaml.MappingNode, name: str) -> None:
        self.file = file
        self.name = name
        self._node = node
        self._items: dict[str, tuple[yaml.Node, yaml.Node]] = {}
        self._asked: dict[str, None] = {}
        for key, value in node.value:
            text = str(getattr(key, "value", ""))
            if text in self._items:
                self._fail(key, f"{text} is given twice in {name}, expected once", "remove one of the two")
            self._items[text] = (key, value)

    @property
    def span(self) -> Span:
        """The span of the mapping."""
        return _span(self.file, self._node)

    @property
    def keys(self) -> tuple[str, ...]:
        """Return the present keys, in order."""
        return tuple(self._items)

    def has(self, key: str) -> bool:
        """Return whether the key is present (and not null)."""
        self._asked[key] = None
        return key in self._items and self._plain(self._items[key][1]) is not None

    def is_text(self, key: str) -> bool:
        """Return whether the key has a plain text, for keys that may also have a mapping."""
        return self.has(key) and isinstance(self._plain(self._items[key][1]), str)

    def number(
        self, key: str, default: object = _REQUIRED, *, minimum: float | None = None, maximum: float | None = None
    ) -> float:
        """Read a finite number within limits (inclusive)."""
        value = self._get(key, default, "a number")
        if not _is_number(value):
            self.fail(key, f"{key}: {value!r} in {self.name}, expected a number")
        if (minimum is not None and value < minimum) or (maximum is not None and value > maximum):
            self.fail(key, f"{key}: {value!r} in {self.name}, expected {_limits(minimum, maximum)}")
        return float(value)

    def integer(self, key: str, default: object = _REQUIRED, *, minimum: int | None = None) -> int:
        """Read a whole number not below `minimum`."""
        value = self._get(key, default, "a whole number")
        if isinstance(value, bool) or not isinstance(value, int):
            self.fail(key, f"{key}: {value!r} in {self.name}, expected a whole number")
        if minimum is not None and value < minimum:
            self.fail(key, f"{key}: {value!r} in {self.name}, expected at least {minimum}")
        return value

    def text(self, key: str, default: object = _REQUIRED, *, choices: Iterable[str] = ()) -> str:
        """Read a string; with `choices`, one of them."""
        value = self._get(key, default, "a text")
        if not isinstance(value, str):
            self.fail(key, f"{key}: {value!r} in {self.name}, expected a text")
        allowed = list(choices)
        if allowed and value not in allowed:
            near = did_you_mean(value, allowed)
            self.fail(
                key,
                f"{key}: {value!r} in {self.name}, expected one of {', '.join(allowed)}",
                f"did you mean {near!r}?" if near else None,
            )
        return value

    def boolean(self, key: str, default: object = _REQUIRED) -> bool:
        """Read true or false; 0 and 1 are accepted too."""
        value = self._get(key, default, "true or false")
        if value not in (True, False):
            self.fail(key, f"{key}: {value!r} in {self.name}, expected true or false")
        return bool(value)

    def numbers(self, key: str, length: int | None = None, default: object = _REQUIRED) -> tuple[float, ...]:
        """Read a list of finite numbers, of a fixed length if one is given."""
        expected = f"a list of {length} numbers" if length else "a list of numbers"
        value = self._get(key, default, expected)
        if isinstance(value, tuple):
            return value
        if (
            not isinstance(value, list)
            or not all(map(_is_number, value))
            or (length is not None and len(value) != length)
        ):
            help = "write 0.0 where it says nan" if "nan" in str(value).lower() else None
            self.fail(key, f"{key}: {value!r} in {self.name}, expected {expected}", help)
        return tuple(float(x) for x in value)

    def points(self, key: str, default: object = _REQUIRED, *, minimum: int = 0) -> tuple[tuple[float, float], ...]:
        """Read a list of [x, y] pairs, at least `minimum` of them."""
        value = self._get(key, default, "a list of [x, y] points")
        if isinstance(value, tuple):
            return value
        if (
            not isinstance(value, list)
            or len(value) < minimum
            or not all(isinstance(p, list) and len(p) == 2 and all(map(_is_number, p)) for p in value)
        ):
            self.fail(key, f"{key}: {value!r} in {self.name}, expected a list of at least {minimum} [x, y] points")
        return tuple((float(x), float(y)) for x, y in value)

    def section(self, key: str) -> Section:
        """Read a mapping inside this one. Raises UserError if it is missing."""
        if not self.has(key):
            self.fail(key, f"{key} is missing in {self.name}, expected a mapping")
        return self._section(self._items[key][1], f"{self.name}, {key}")

    def optional_section(self, key: str) -> Section | None:
        """Read a mapping inside this one, or None if it is missing."""
        return self.section(key) if self.has(key) else None

    def sections(self, key: str) -> Iterator[Section]:
        """Yield each mapping of a list of mappings; empty if the key is missing."""
        if not self.has(key):
            return
        node = self._items[key][1]
        if not isinstance(node, yaml.SequenceNode):
            self.fail(key, f"{key} in {self.name}, expected a list of mappings")
        for number, item in enumerate(node.value, start=1):
            yield self._section(item, f"{self.name}, {key} {number}")

    def subsections(self) -> Iterator[tuple[str, Section]]:
        """Yield every key with its value as a mapping, for mappings whose keys are names chosen by the user."""
        for key in self._items:
            yield key, self.section(key)

    def merged(self, over: Section) -> Section:
        """Return this mapping with the values of another one merged over it, mapping by mapping; positions are kept."""
        return Section(self.file, _merge(self._node, over._node), self.name)

    def with_numbers(self, *keys: str) -> Section:
        """Return this mapping with the texts of these keys as yaml-cpp takes them: `"0.05"` and `1e-3` are numbers."""
        pairs = [(k, _as_number(v) if getattr(k, "value", None) in keys else v) for k, v in self._node.value]
        node = yaml.MappingNode(self._node.tag, pairs, self._node.start_mark, self._node.end_mark)
        read = Section(self.file, node, self.name)
        read._asked = self._asked
        return read

    def without(self, key: str) -> Section:
        """Return this mapping without one of its keys."""
        pairs = [(k, v) for k, v in self._node.value if getattr(k, "value", None) != key]
        node = yaml.MappingNode(self._node.tag, pairs, self._node.start_mark, self._node.end_mark)
        return Section(self.file, node, self.name)

    def finish(self) -> None:
        """Refuse keys that no accessor has read: they are misspelt or misplaced."""
        for key, (node, _) in self._items.items():
            if key not in self._asked:
                near = did_you_mean(key, self._asked)
                help = f"did you mean {near!r}?" if near else f"known here: {', '.join(sorted(self._asked))}"
                self._fail(node, f"{key} is not known in {self.name}", help)

    def fail(self, key: str, message: str, help: str | None = None) -> NoReturn:
        """Raise UserError at the value of a key (at the mapping if the key is missing)."""
        self._fail(self._items[key][1] if key in self._items else self._node, message, help)

    def _fail(self, node: yaml.Node, message: str, help: str | None) -> NoReturn:
        raise user_error(message, _span(self.file, node), rule="bad-value", help=help)

    def _section(self, node: yaml.Node, name: str) -> Section:
        if not isinstance(node, yaml.MappingNode):
            self._fail(node, f"a {_kind(node)}, expected a mapping for {name}", None)
        return Section(self.file, node, name)

    def _get(self, key: str, default: object, expected: str) -> object:
        if not self.has(key):
            if default is _REQUIRED:
                near = did_you_mean(key, set(self._items) - set(self._asked))
                help = f"did you mean {key!r} where it says {near!r}?" if near else None
                self.fail(key, f"{key} is missing in {self.name}, expected {expected}", help)
            return default
        return self._plain(self._items[key][1])

    def _plain(self, node: yaml.Node) -> object:
        try:
            return construct_yaml(node)
        except ValueError as problem:
            self._fail(node, f"a value that YAML cannot read: {problem}", None)


def _is_number(value: object) -> TypeGuard[float]:
    # Finite also as a float, which integers of 400 digits are not.
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) <= sys.float_info.max


def _as_number(node: yaml.Node) -> yaml.Node:
    if isinstance(node, yaml.SequenceNode):
        inner = [_as_number(each) for each in node.value]
        return yaml.SequenceNode(node.tag, inner, node.start_mark, node.end_mark)
    if node.tag.endswith((":str", ":int")) and _NUMBER.fullmatch(node.value):
        return yaml.ScalarNode("tag:yaml.org,2002:float", node.value, node.start_mark, node.end_mark)
    return node


def _kind(node: yaml.Node) -> str:
    return {yaml.ScalarNode: "single value", yaml.SequenceNode: "list"}.get(type(node), "mapping")


def _merge(under: yaml.MappingNode, over: yaml.MappingNode) -> yaml.MappingNode:
    pairs: dict[str, tuple[yaml.Node, yaml.Node]] = {str(k.value): (k, v) for k, v in under.value}
    for key, value in over.value:
        name = str(key.value)
        old = pairs.get(name)
        if old and isinstance(old[1], yaml.MappingNode) and isinstance(value, yaml.MappingNode):
            value = _merge(old[1], value)
        pairs[name] = (key, value)
    return yaml.MappingNode(under.tag, list(pairs.values()), under.start_mark, under.end_mark)


def _span(file: SourceFile, node: yaml.Node) -> Span:
    start = _offset(file, node.start_mark)
    end = _offset(file, node.end_mark)
    first_line_end = file.text.find("\n", start)
    return Span(file, start, min(end, first_line_end) if first_line_end != -1 else end)


def _offset(file: SourceFile, mark: yaml.Mark | None) -> int:
    # libyaml counts bytes in `index` but characters in `column`; lines are safe in both.
    if mark is None:
        return 0
    offset = 0
    for _ in range(mark.line):
        offset = file.text.find("\n", offset) + 1
    return min(offset + int(mark.column), len(file.text))


def _limits(minimum: float | None, maximum: float | None) -> str:
    if minimum is not None and maximum is not None:
        return f"{minimum:g} to {maximum:g}"
    return f"at least {minimum:g}" if minimum is not None else f"at most {maximum:g}"
