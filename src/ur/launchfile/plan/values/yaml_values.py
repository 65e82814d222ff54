"""YAML as roslaunch reads it: PyYAML's safe loader with ROS's angles, and the position of every key."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

from ur.launchfile.plan.specs import ParamValue
from ur.launchfile.plan.values.budget import PER_YAML_CHARACTER, Budget, TooLong

if TYPE_CHECKING:
    import yaml

MAX_VALUES = 1_000_000
_MAX_MERGED = 100_000
_ANGLES = 200_000  # units of work (`ur.launchfile.plan.values.budget`) for all angles of a text that is in no file


# Texts that libyaml reads as PyYAML's own parser does, which roslaunch uses: no quotes, comments, anchors or tags, each
# colon ends a key, no line is long, nothing is deep.
_SIMPLE = re.compile(r"[A-Za-z0-9_./+()\[\]{}, :\n-]*")
_NOT_SIMPLE = re.compile(
    r":(?![ \n]|\Z)|^(?:---|\.\.\.)|[\[{,]\s*[-:,]|[^\n]{500}|[\[{](?:[^\]}]*[\[{]){20}", re.MULTILINE
)


class YamlProblem(Exception):  # noqa: N818 - carries a finding to where its place is known
    """A text is not YAML that roslaunch could load. `offset` is the position, in characters."""

    def __init__(self, message: str, offset: int = 0, help: str | None = None) -> None:
        super().__init__(message)
        self.offset = offset
        self.help = help


class Document:
    """A value, and the positions of the keys of its mappings."""

    __slots__ = ("_keys", "_node", "value")

    def __init__(self, value: ParamValue, node: yaml.Node | None) -> None:
        self.value = value
        self._node = node
        self._keys: dict[int, dict[str, tuple[yaml.Node, yaml.Node]]] = {}  # by the id of a node, which `_node` keeps

    def place_of(self, path: tuple[str, ...]) -> tuple[int, int]:
        """Return start and end, in characters, of the key at a path of keys, or of the nearest key with a position."""
        node = self._node
        place = (0, 0)
        for key in path:
            known = self._keys.get(id(node))
            if known is None:
                pairs = [each for each in getattr(node, "value", ()) if isinstance(each, tuple)]
                known = {each[0].value: each for each in pairs if isinstance(each[0].value, str)}
                self._keys[id(node)] = known
            found = known.get(str(key))
            if not found:
                break
            name, node = found
            place = (name.start_mark.index, name.end_mark.index)
        return place


def read_yaml(text: str, reads_angles: bool, budget: Budget | None = None) -> Document:
    """Return the value of a text; an empty mapping for an empty text.

    `reads_angles`: `deg(...)` and `rad(...)` are numbers. Reading is charged to `budget`, that of the launch file.
    Raises YamlProblem, also for values that aliases make larger than any parameter of a robot.
    """
    import yaml  # takes 10 ms, and most launch files hold no YAML

    _charge(budget, len(text) * PER_YAML_CHARACTER // 4)
    document = _read_fast(text, reads_angles, budget)
    if document is not None:
        return document
    _charge(budget, len(text) * PER_YAML_CHARACTER * 3 // 4)
    loader = None
    try:
        loader = _loader_class(reads_angles)(text.removeprefix("\ufeff"))  # it refuses some characters at once
        vars(loader)["budget"] = budget or Budget(_ANGLES)
        node = loader.get_single_node()
        value = loader.construct_document(node) if node is not None else None
    except yaml.MarkedYAMLError as problem:
        mark = problem.problem_mark or problem.context_mark
        message = " ".join(part for part in (problem.context, problem.problem) if part)
        help_ = _help(message, problem.context_mark)
        raise YamlProblem(message, mark.index if mark else 0, help_) from None
    except yaml.YAMLError as problem:
        raise YamlProblem(str(problem).splitlines()[0], getattr(problem, "position", 0) or 0) from None
    except RecursionError:
        raise YamlProblem("nested too deep") from None
    except (ValueError, TypeError, OverflowError, LookupError, AttributeError) as problem:
        raise YamlProblem(f"a value cannot be read: {problem}") from None
    finally:
        if loader is not None:
            loader.dispose()
    _check_size(value)
    return Document(value, node)


def read_yaml_once(text: str, reads_angles: bool, budget: Budget | None = None) -> Document:
    """Read as `read_yaml` does, and cache it: a check loads the same file in many cases.

    The value must not be changed.
    """
    return _read_known(text, reads_angles, _Payer(budget))


class _Payer:
    # Equal to all others: what one file has been charged for is not charged again.
    def __init__(self, budget: Budget | None) -> None:
        self.budget = budget

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Payer)

    def __hash__(self) -> int:
        return 0


@lru_cache(maxsize=64)
def _read_known(text: str, reads_angles: bool, payer: _Payer) -> Document:
    return read_yaml(text, reads_angles, payer.budget)


def _charge(budget: Budget | None, units: int) -> None:
    try:
        if budget is not None:
            budget.charge(units)
    except TooLong as problem:
        raise YamlProblem(str(problem), 0, "split the launch file") from None


def _read_fast(text: str, reads_angles: bool, budget: Budget | None) -> Document | None:
    # None: PyYAML's own parser decides, and words the error.
    if _SIMPLE.fullmatch(text) is None or _NOT_SIMPLE.search(text) is not None:
        return None
    import yaml

    if not yaml.__with_libyaml__:
        return None
    loader = _loader_class(reads_angles, fast=True)(text)
    vars(loader)["budget"] = budget or Budget(_ANGLES)
    try:
        node = loader.get_single_node()
        value = loader.construct_document(node) if node is not None else None
    except (yaml.YAMLError, RecursionError, ValueError, TypeError, OverflowError, LookupError, AttributeError):
        return None
    finally:
        loader.dispose()
    return Document(value, node)


def _help(message: str, began: yaml.Mark | None) -> str:
    if "\\t" in message:
        return "indent with spaces: YAML takes no tabs"
    for kind, bracket in (("flow sequence", "["), ("flow mapping", "{")):
        if kind in message and began is not None:
            return f"close the '{bracket}' that line {began.line + 1} of the YAML opens"
    if "block" in message:
        return "let keys of one mapping begin in the same column"
    if "alias" in message:
        return "define it first: &name"
    return "put texts that hold special characters in quotes"


@cache
def _loader_class(reads_angles: bool, fast: bool = False) -> Callable[[str], yaml.SafeLoader]:
    import yaml

    base: Any = yaml.CSafeLoader if fast else yaml.SafeLoader

    class Loader(base):  # type: ignore[misc]  # which one is known when it is made
        def flatten_mapping(self, node: yaml.MappingNode) -> None:
            super().flatten_mapping(node)
            if len(node.value) > _MAX_MERGED:
                raise yaml.constructor.ConstructorError(None, None, "merged mappings grow too large", node.start_mark)

    if reads_angles:
        for tag, pattern, letter, convert in (
            ("!degrees", r"^deg\([^\)]*\)$", "deg(", _read_degrees),
            ("!radians", r"^rad\([^\)]*\)$", "rad(", _read_radians),
        ):
            Loader.add_constructor(tag, convert)
            Loader.add_implicit_resolver(tag, re.compile(pattern), letter)
    return Loader


def _read_degrees(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> float:
    text = loader.construct_scalar(node)
    inner = text.strip()[4:-1] if text.startswith("deg(") else text
    return float(inner) * math.pi / 180.0


def _read_radians(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> float:
    # roslaunch evaluates the text as Python, in which only `pi` is intended to be known.
    text = loader.construct_scalar(node).strip()
    inner = text[4:-1] if text.startswith("rad(") else text
    import yaml

    from ur.launchfile.plan.values.expression import ExpressionProblem, evaluate_expression

    try:
        return float(evaluate_expression(inner, {}, {"pi": math.pi}.__getitem__, (), vars(loader)["budget"]))
    except ExpressionProblem as problem:
        raise yaml.constructor.ConstructorError(None, None, f"not an angle: {problem}", node.start_mark) from None


def _check_size(value: object) -> None:
    # Aliases let a small text mean a huge value, or one that holds itself.
    sizes: dict[int, int] = {}

    def size_of(item: object, depth: int) -> int:
        if not isinstance(item, (dict, list)):
            return 1
        known = sizes.get(id(item))
        if known is not None:
            if known < 0:
                raise YamlProblem("a value holds itself", 0, "remove the alias (*name) inside of what it names")
            return known
        if depth > 200:
            raise YamlProblem("nested more than 200 deep")
        sizes[id(item)] = -1
        inner = item.values() if isinstance(item, dict) else item
        total = sizes[id(item)] = 1 + sum(size_of(part, depth + 1) for part in inner)
        if total > MAX_VALUES:
            raise YamlProblem(f"more than {MAX_VALUES:,} values", 0, "aliases multiply: write less of them")
        return total

    size_of(value, 0)
