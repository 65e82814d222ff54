"""The plan of a run beside its logs, for reports: what was to start, and where each value was written."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, Origin, Plan
from ur.source.foreign.files import read_text
from ur.source.foreign.json_values import read_json, write_json

_LONGEST = 2000  # characters of a value
_MOST_BYTES = 8_000_000


def plan_path(log_folder: str, run: str) -> Path:
    """The file of a run's plan."""
    return Path(log_folder, f"{run}.plan.json")


def write_plan(path: Path, plan: Plan, nodes: Sequence[NodeSpec], arguments: Sequence[str]) -> None:
    """Write the plan of a run, for its user only. Raises OSError."""
    values = {
        "arguments": list(arguments),
        "files": list(plan.files),
        "nodes": {
            node.full_name: {
                "program": f"{node.package}/{node.type}",
                "arguments": node.args,
                "machine": node.machine or "",
                "written at": describe_origin(node.origin),
            }
            for node in nodes
        },
        "parameters": {each.name: str(each.value)[:_LONGEST] for each in plan.params},
        "origins": [f"{each.name} is written at {describe_origin(each.origin)}" for each in plan.params],
    }
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with os.fdopen(descriptor, "w", encoding="utf-8", errors="replace") as file:
        file.write(write_json(values))


def read_plan(path: Path) -> dict[str, object]:
    """The plan of a run; {} where there is none."""
    try:
        found = read_json(read_text(path, _MOST_BYTES), dict[str, object])
    except (OSError, ValueError):
        return {}
    return found


def describe_origin(origin: Origin) -> str:
    """The place where something was written: file and line, then those of the includes."""
    return ", included at ".join(f"{span.file.path}:{span.position.line}" for span in (origin.span, *origin.includes))
