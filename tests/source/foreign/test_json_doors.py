"""JSON is read by `ur.source.foreign.json_values`; modules that read it by themselves are listed here."""

from __future__ import annotations

import ast
from pathlib import Path

SRC = Path(__file__).parents[3] / "src"
CODEC = "ur/source/foreign/json_values.py"

SENT = "runs on a robot as one file, with the Python of its system and without the library"
SYSTEM = "runs with the Python of the system, without the library"
CONFINED = "runs confined, and has no more than xacro needs"
OWN = "a file that other nodes of the run have written; no value has a type"

# Module, and why it reads JSON by itself.
ALLOWED = {
    "ur/devices/probe_program.py": SENT,
    "ur/robot/deploy/repository_side.py": SENT,
    "ur/robot/description/expansion/confined.py": CONFINED,
    "ur/robot/ros2/finder.py": SENT,
    "ur/robot/sync/side.py": SENT,
    "ur_nodes/camera/libcamera_program.py": SYSTEM,
    "ur_nodes/file_facts.py": OWN,
}


def reads_json(text: str) -> bool:
    """Return whether a module's text calls json.load or json.loads."""
    calls = [ast.unparse(node.func) for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    return bool({"json.load", "json.loads", "JSONDecoder", "json.JSONDecoder"} & {*calls})


def test_json_is_read_by_the_codec_only() -> None:
    modules = {path.relative_to(SRC).as_posix(): path.read_text(encoding="utf-8") for path in SRC.rglob("*.py")}
    found = {name for name, text in modules.items() if reads_json(text)} - {CODEC}
    assert found - {*ALLOWED} == set(), "read it by ur.source.foreign.json_values, with its limits in a type"
    assert {*ALLOWED} - found == set(), "remove it from ALLOWED"
