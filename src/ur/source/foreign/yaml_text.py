"""Untrusted YAML, with limits on its nesting (before parsing), its numbers, and the expansion of its aliases."""

from functools import lru_cache
from typing import Any, NamedTuple

import yaml

MAX_DEPTH = 100
MAX_VALUES = 100_000
_SAFE_COUNT = 1000  # so many levels do not exhaust the stack
_PER_VALUE = 100  # characters of a text count as one more value
_LONGEST_NUMBER = 1000  # characters; of those with colons, the time grows with the square of it
_LONGEST_KEY = 18  # digits of a number that is a key: among longer ones, many can have the same hash
_PLAIN = {"true": True, "false": False, "0": 0}  # values of many parameters
_NUMBERS = frozenset({"tag:yaml.org,2002:int", "tag:yaml.org,2002:float"})
LOADER: type[yaml.SafeLoader] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class DumpedYaml(NamedTuple):
    """The content of a file whose text is made where it is needed, by `str`: PyYAML takes long for it."""

    content: object

    def __str__(self) -> str:
        return yaml.dump(self.content)


def load_yaml(text: str, values: int = MAX_VALUES) -> Any:
    """Return the value of a text of at most `values` values, including aliases; None for an empty text.

    Raises ValueError, whose text is the reason in one line: not YAML, nested too deeply, or too large.
    """
    if text in _PLAIN:
        return _PLAIN[text]
    if text.isdecimal() and text.isascii() and len(text) < _LONGEST_KEY and text[0] != "0":
        return int(text)
    try:
        node = compose_yaml(text)
        return None if node is None else construct_yaml(node, values)
    except yaml.YAMLError as problem:
        raise ValueError(describe_problem(problem)) from None


@lru_cache(maxsize=16)
def load_shared_yaml(text: str) -> Any:
    """Return the value of a text, likewise. It may be shared: do not change it."""
    return load_yaml(text)


def compose_yaml(text: str) -> yaml.Node | None:
    """Return the node of a text, for values with positions. Raises yaml.YAMLError."""
    check_depth(text)
    try:
        node: yaml.Node | None = yaml.compose(text, Loader=LOADER)
    except (ValueError, RecursionError) as problem:  # ValueError: characters that are not UTF-8
        raise yaml.YAMLError(str(problem)) from None
    return node


def construct_yaml(node: yaml.Node, values: int = MAX_VALUES) -> object:
    """Return the value of a node. Raises ValueError in one line, also for one that its aliases make too large."""
    loader = LOADER("")
    try:
        check_size(node, values)
        return loader.construct_document(node)
    except yaml.YAMLError as problem:
        raise ValueError(describe_problem(problem)) from None
    except RecursionError:
        raise ValueError("nested too deep") from None
    except (TypeError, OverflowError, LookupError, AttributeError) as problem:
        raise ValueError(str(problem)) from None
    finally:
        loader.dispose()


def check_depth(text: str) -> None:
    """Raise yaml.YAMLError for a text that is nested deeper than MAX_DEPTH, or is not YAML.

    libyaml composes nodes by recursion in C: a text of 100 kB can exhaust the stack, without an exception.
    """
    if sum(map(text.count, "[{-?:")) <= _SAFE_COUNT:
        return  # each level of nesting takes one of these characters
    depth = 0
    try:
        for event in yaml.parse(text, Loader=LOADER):
            if isinstance(event, yaml.CollectionStartEvent):
                depth += 1
                if depth > MAX_DEPTH:
                    mark: Any = event.start_mark  # two classes, one of which PyYAML's stubs do not let it take
                    raise yaml.composer.ComposerError(None, None, f"nested deeper than {MAX_DEPTH} levels", mark)
            elif isinstance(event, yaml.CollectionEndEvent):
                depth -= 1
    except (ValueError, RecursionError) as problem:
        raise yaml.YAMLError(str(problem)) from None


def check_size(top: yaml.Node, values: int = MAX_VALUES) -> None:
    """Raise yaml.YAMLError for a node with more than `values` values including aliases, or one that contains itself."""
    counts: dict[int, int] = {}

    def count(node: yaml.Node) -> int:
        known = counts.get(id(node))
        if known is not None:
            return known
        counts[id(node)] = values + 1  # as long as it is being counted: then it contains itself
        total = 1
        if isinstance(node, yaml.SequenceNode):
            total += sum(map(count, node.value))
        elif isinstance(node, yaml.MappingNode):
            for key, value in node.value:
                _check_number(key, _LONGEST_KEY)
                total += count(key) + count(value)
        else:
            _check_number(node, _LONGEST_NUMBER)
            total += len(node.value) // _PER_VALUE
        counts[id(node)] = total
        return total

    if count(top) > values:
        raise yaml.composer.ComposerError(None, None, f"more than {values:,} values with its aliases", top.start_mark)


def describe_problem(problem: yaml.YAMLError) -> str:
    """Describe an error in a text in one line, with the line number if it is known."""
    if not isinstance(problem, yaml.MarkedYAMLError):
        return " ".join(str(problem).split())[:200]
    mark = problem.problem_mark or problem.context_mark
    what = " ".join(part for part in (problem.context, problem.problem) if part)
    return f"line {mark.line + 1}: {what}" if mark else what


def _check_number(node: yaml.Node, longest: int) -> None:
    if node.tag in _NUMBERS and len(node.value) > longest:
        message = f"a number of {len(node.value)} characters, expected at most {longest}"
        raise yaml.constructor.ConstructorError(None, None, message, node.start_mark)
