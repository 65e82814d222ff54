"""Parameters of nodes: values as launch_ros types them, and files with their sections.

Source of the rules: `normalize_parameters` and `evaluate_parameters` of launch_ros; rcl's for sections of files.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any, cast

from ur.launchfile.plan.specs import ParamValue
from ur.launchfile.plan.values.budget import PER_YAML_CHARACTER
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.substitutions import perform
from ur.source.file import Span


class TypedList(list[ParamValue]):
    """A list of a ParameterValue, which launch_ros writes as such; it writes others as tuples of Python."""


_SCALARS = (bool, int, float, str)


def read_values(
    values: Mapping[object, object], span: Span, context: Context, prefix: str = ""
) -> Iterator[tuple[str, ParamValue | Unknown]]:
    """Yield the parameters of a dict by their full names. Raises DescriptionProblem."""
    for key, value in values.items():
        name = perform(key, context)
        if isinstance(name, Unknown):
            yield f"{prefix}(a name that is not known)", name
        elif isinstance(value, Mapping):
            yield from read_values(value, span, context, f"{prefix}{name}.")
        else:
            yield prefix + name, read_value(value, prefix + name, span, context)


def read_value(value: object, name: str, span: Span, context: Context) -> ParamValue | Unknown:
    """Return the value of a parameter as launch_ros passes it on. Raises DescriptionProblem."""
    if isinstance(value, Unknown):
        return value
    if isinstance(value, Made) and value.kind == "ParameterValue":
        typed = _typed(value, name, context)
        return TypedList(typed) if isinstance(typed, list) else typed
    if isinstance(value, (bool, int, float, str, bytes)):
        return value
    if isinstance(value, Made):
        text = perform(value, context)
        return text if isinstance(text, Unknown) else _from_text(text, name, value.span, context)
    if isinstance(value, (list, tuple)):
        return _read_list(value, name, span, context)
    if isinstance(value, PurePosixPath):
        raise DescriptionProblem(
            f"parameter {name} is a path, expected a text: str(...)", "bad-param-value", span, None, name
        )
    message = f"parameter {name} is of type {type(value).__name__}, expected a number, text, flag or list"
    raise DescriptionProblem(message, "bad-param-value", span, None, name)


def _read_list(values: Sequence[object], name: str, span: Span, context: Context) -> ParamValue | Unknown:
    if not values:
        raise DescriptionProblem(
            f"parameter {name} is an empty list, expected a list whose type shows", "bad-param-value", span,
            "leave it out: the default of the node is used", name,
        )  # fmt: skip
    kinds = {"substitution" if isinstance(each, Made) else type(each) for each in values}
    if any(isinstance(each, Unknown) for each in values):
        return next(each for each in values if isinstance(each, Unknown))
    if kinds <= {int} or kinds <= {bool}:
        return cast("ParamValue", list(values))
    if kinds <= {int, float}:
        return [float(cast("float", each)) for each in values]
    if "substitution" in kinds and kinds <= {"substitution", str}:
        text = perform(list(values), context)
        return text if isinstance(text, Unknown) else _from_text(text, name, span, context)
    texts = [each if isinstance(each, str) else perform(each, context) for each in values]
    for text in texts:
        if isinstance(text, Unknown):
            return text
    if kinds <= {str}:
        return cast("ParamValue", texts)
    parsed = [_load(str(text), name, span, context) for text in texts]
    return _uniform(parsed, name, span)


def _from_text(text: str, name: str, span: Span, context: Context) -> ParamValue:
    value = _load(text or "''", name, span, context)
    if isinstance(value, (*_SCALARS, bytes)):
        return cast("ParamValue", value)
    if isinstance(value, list):
        return _uniform(value, name, span)
    help_ = "write ParameterValue(..., value_type=str) for a text"
    raise DescriptionProblem(
        f"parameter {name} reads as {_describe(value)}, expected a number, text, flag or list",
        "bad-param-value",
        span,
        help_,
        name,
    )


def _load(text: str, name: str, span: Span, context: Context) -> object:
    try:
        return context.load_yaml(text)
    except ValueError as problem:
        help_ = "write ParameterValue(..., value_type=str) for a text"
        raise DescriptionProblem(
            f"parameter {name} is no YAML: {problem}", "bad-param-value", span, help_, name
        ) from None


def _uniform(values: list[object], name: str, span: Span) -> ParamValue:
    first = type(values[0]) if values else None
    if first not in _SCALARS or any(type(each) is not first for each in values):
        message = f"parameter {name} is a list of several types or empty, expected items of one type"
        raise DescriptionProblem(message, "bad-param-value", span, None, name)
    return cast("ParamValue", values)


def _typed(made: Made, name: str, context: Context) -> ParamValue | Unknown:
    """Return the value of a ParameterValue, as launch's `perform_typed_substitution`."""
    value, kind, span = made.get("value"), made.get("value_type"), made.place("value")
    for each in (value, kind):
        if isinstance(each, Unknown):
            return each
    if isinstance(value, (*_SCALARS, PurePosixPath)):
        return cast("ParamValue", _check(value, kind, name, span))
    if not isinstance(value, (list, tuple)) or (
        any(isinstance(each, Made) for each in value) and all(isinstance(each, (Made, str)) for each in value)
    ):
        text = perform(value, context)
        context.budget.charge(0 if isinstance(text, Unknown) else PER_YAML_CHARACTER * len(text))
        return text if isinstance(text, Unknown) else coerce(text, kind, name, span)
    items: list[object] = []
    for each in value:
        item = each if isinstance(each, _SCALARS) else perform(each, context)
        if isinstance(item, Unknown):
            return item
        context.budget.charge(PER_YAML_CHARACTER * len(str(item)))
        items.append(item if each is item else coerce(str(item), _item_of(kind), name, span))
    if kind in (None, list[float]) and {type(each) for each in items} == {int, float}:
        items = [float(cast("float", each)) for each in items]
    return cast("ParamValue", _check(items, kind, name, span))


def coerce(text: str, kind: object, name: str, span: Span) -> ParamValue:
    """Return a text as a value of a type, one of YAML's if it is None. Raises DescriptionProblem."""
    if kind is str or (kind is None and not text):
        return text
    from ur.source.foreign.yaml_text import load_yaml  # as in the context

    value: object
    try:
        if kind in (int, float):
            return cast("type[float]", kind)(text)
        value = load_yaml({"1": "true", "0": "false"}.get(text, text) if kind is bool else text)
    except ValueError:
        value = None
    return cast("ParamValue", _check(value, kind, name, span, text))


def _check(value: object, kind: object, name: str, span: Span, text: object = None) -> object:
    wanted = _item_of(kind)
    if isinstance(value, list):
        first = type(value[0]) if value else str
        fits = kind is None or wanted is not None
        fits = fits and all(isinstance(each, cast("type", wanted or first)) for each in value) and first in _SCALARS
    else:
        fits = isinstance(value, _SCALARS if kind is None else cast("type", kind)) if wanted is None else False
    if not fits:
        shown = value if text is None else text
        expected = (
            "a number, text, flag or list of one of these" if kind is None else f"a value of type {_name_of(kind)}"
        )
        message = f"parameter {name} is {shown!r}, expected {expected}"
        raise DescriptionProblem(message, "bad-param-value", span, None, name)
    return value


def _item_of(kind: object) -> object:
    """Return the type of the items of a type of lists; None for any other."""
    return cast("tuple[object, ...]", getattr(kind, "__args__", (None,)))[0]


def _name_of(kind: object) -> str:
    return str(kind) if _item_of(kind) is not None else getattr(kind, "__name__", str(kind))


def _describe(value: object) -> str:
    return {"NoneType": "nothing", "dict": "a map"}.get(type(value).__name__, type(value).__name__)


class ParameterSections:
    """The sections of one parameter file: for each, the nodes that it names, and its parameters."""

    def __init__(self, content: object) -> None:
        self.is_mapping = isinstance(content, Mapping) and bool(content)
        self.sections: list[tuple[str, Mapping[str, object]]] = list(_find_sections(content, ""))
        """Patterns of full node names, `*` for one part and `**` for any, with the values below `ros__parameters`."""

    def matching(self, node: str) -> Iterator[tuple[str, object]]:
        """Yield the parameters for a node by their full names; later ones win."""
        exact = [values for pattern, values in self.sections if pattern == node]
        wild = [values for pattern, values in self.sections if pattern != node and matches(pattern, node)]
        for values in (*wild, *exact):
            yield from flatten(values)


def matches(pattern: str, node: str) -> bool:
    """Return whether a section of a parameter file is for a node; both are full names."""
    expression = "".join(
        "(?:/[^/]+)*" if part == "**" else "/[^/]+" if part == "*" else "/" + re.escape(part)
        for part in pattern.strip("/").split("/")
    )
    return re.fullmatch(expression, node) is not None


def flatten(values: Mapping[str, object], prefix: str = "") -> Iterator[tuple[str, object]]:
    """Yield parameters by their full names, with dots."""
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from flatten(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _find_sections(content: object, name: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    if not isinstance(content, Mapping):
        return
    for key, value in content.items():
        if key == "ros__parameters":
            if isinstance(value, Mapping):
                yield name or "/**", value
        else:
            part = str(key).strip("/")
            yield from _find_sections(value, f"{name}/{part}" if part else name)
