"""Default values of a node's private parameters, read from its Python source without running it."""

import ast
from collections.abc import Iterator, Mapping
from dataclasses import replace

from ur.tools.new.parts import Observed

_MOST_CHARACTERS = 1_000_000
_READERS = {"number", "integer", "text", "boolean", "texts", "points", "any"}
"""Methods of `ur_nodes.ports.parameters.Parameters`, whose names are those below the node."""


def read_defaults(source: str) -> Mapping[str, object]:
    """Return literal defaults of calls such as `get_param("~near", 0.7)` or `parameters.number("near", 0.7)`, by name.

    A computed default is left out, and so is a parameter that is read with two different defaults. A source that is not
    Python has none.
    """
    if len(source) > _MOST_CHARACTERS:
        return {}
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return {}
    found: dict[str, object] = {}
    differing = set()
    for name, value in _calls(tree):
        if name in found and found[name] != value:
            differing.add(name)
        found[name] = value
    return {name: value for name, value in found.items() if name not in differing}


def add_defaults(observed: Observed, defaults: Mapping[str, object]) -> Observed:
    """Set the defaults of the source on parameters that the node read and that had no value."""
    values = {name: defaults.get(name) if value is None else value for name, value in observed.parameters.items()}
    return replace(observed, parameters=values)


def _calls(tree: ast.Module) -> Iterator[tuple[str, object]]:
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        function = _function(node.func)
        if function != "get_param" and function not in _READERS:
            continue
        arguments = [*node.args, *(each.value for each in node.keywords if each.arg == "default")]
        if len(arguments) != 2:
            continue
        try:
            name, value = (ast.literal_eval(each) for each in arguments)
        except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
            continue
        known = isinstance(name, str) and isinstance(value, (bool, int, float, str, list, dict))
        if known and (function in _READERS or name.startswith("~")):
            yield name.removeprefix("~"), value


def _function(function: ast.expr) -> str:
    if isinstance(function, ast.Attribute):
        return function.attr
    return function.id if isinstance(function, ast.Name) else ""
