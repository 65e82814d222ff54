"""Values of parameters as ROS 2 has them: numbers, texts, flags and lists of one kind. Pure.

A list of maps becomes a map by their `name`; other nested lists become texts, as Nav2 has them.
"""

import json
from collections.abc import Mapping


def convert_map(values: Mapping[str, object]) -> dict[str, object]:
    """The parameters of a node, without those that have no value."""
    converted = {str(name): _convert(value) for name, value in values.items()}
    return {name: value for name, value in converted.items() if value not in (None, {}, [])}


def _convert(value: object) -> object:
    if isinstance(value, dict):
        return convert_map(value)
    if isinstance(value, (list, tuple)):
        return _convert_list(list(value))
    if isinstance(value, bytes):
        return list(value)
    return value


def _convert_list(items: list[object]) -> object:
    named = [each for each in items if isinstance(each, dict) and isinstance(each.get("name"), str)]
    if items and len(named) == len(items):
        return convert_map({each["name"]: {k: v for k, v in each.items() if k != "name"} for each in named})
    if any(isinstance(each, (dict, list, tuple)) for each in items):
        return json.dumps(items)
    numbers = [float(each) for each in items if isinstance(each, (int, float)) and not isinstance(each, bool)]
    if len(numbers) == len(items) and any(isinstance(each, float) for each in items):
        return numbers
    if len({type(each) for each in items}) > 1:
        return [str(each) for each in items]
    return items
