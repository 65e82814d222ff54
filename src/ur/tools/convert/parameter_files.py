"""Files of parameters of ROS 1 as those of ROS 2, which say whose parameters they are."""

import json
import math
import re
from dataclasses import dataclass

from ur.launchfile.plan.values.yaml_values import YamlProblem, read_yaml
from ur.launchfile.ros2_values import convert_map
from ur.source.foreign.yaml_text import load_yaml

_SUBSTITUTION = re.compile(r"\$\((find|arg|optenv)\s+([^()$]*)\)")
_NAMES = {"find": "find-pkg-share", "arg": "var", "optenv": "env"}
_INDENT = "    "


@dataclass(frozen=True, slots=True)
class ParameterFile:
    """A file of parameters that a launch file loads for a node: its path, absolute, and its text for ROS 2."""

    path: str
    text: str


def convert_parameters(text: str, substitutes: bool) -> str:
    """The text of a file for ROS 2; comments stay where the values do. Raises ValueError with the reason."""
    if substitutes:
        text = _SUBSTITUTION.sub(lambda found: f"$({_NAMES[found[1]]} {found[2].strip()})", text)
    try:
        value = read_yaml(text, reads_angles=True).value
    except YamlProblem as problem:
        raise ValueError(str(problem)) from None
    if not isinstance(value, dict):
        raise ValueError("expected names with values")
    converted = convert_map(value)
    if not converted:
        return "/**:\n  ros__parameters: {}\n"
    body = text if _can_stay(text, value, converted) else _write_map(converted)
    lines = [f"{_INDENT}{line}".rstrip() for line in body.strip("\n").splitlines()]
    return "\n".join(["/**:", "  ros__parameters:", *lines]) + "\n"


def _can_stay(text: str, value: object, converted: object) -> bool:
    """Test that a text means the same to ROS 2, which knows no angles, when each of its lines is indented."""
    if "---" in text or "%" in text or (re.search(r"[|>][+-]?\d*\s*$", text, re.MULTILINE) is not None):
        return False
    try:
        plain = load_yaml(text)
    except ValueError:
        return False
    return bool(plain == value == converted) and _same_kinds(plain, converted)


def _same_kinds(left: object, right: object) -> bool:
    if isinstance(left, dict) and isinstance(right, dict):
        return all(_same_kinds(each, right[name]) for name, each in left.items())
    if isinstance(left, list) and isinstance(right, list):
        return all(_same_kinds(*pair) for pair in zip(left, right, strict=True))
    return type(left) is type(right)


def _write_map(values: dict[str, object], indent: str = "") -> str:
    lines = []
    for name, value in values.items():
        if isinstance(value, dict):
            lines.append(f"{indent}{json.dumps(name)}:\n{_write_map(value, indent + '  ')}")
        else:
            lines.append(f"{indent}{json.dumps(name)}: {write_value(value)}")
    return "\n".join(lines)


def write_value(value: object) -> str:
    """Return a number, text or list as YAML on one line, with `.inf` and `.nan`, which JSON lacks."""
    if isinstance(value, list):
        return f"[{', '.join(map(write_value, value))}]"
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    return json.dumps(value)
