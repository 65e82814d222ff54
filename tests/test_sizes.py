"""Sizes in src: functions up to 60 lines, modules up to 300, folders up to 15 modules."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src"
MODULES = {path.relative_to(SOURCE).as_posix(): path.read_text(encoding="utf-8") for path in SOURCE.rglob("*.py")}


def test_functions_have_at_most_60_lines() -> None:
    functions = {
        f"{name} {node.name}": (node.end_lineno or 0) - node.lineno + 1
        for name, text in MODULES.items()
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }
    assert {name: lines for name, lines in functions.items() if lines > 60} == {}


def test_modules_have_at_most_300_lines() -> None:
    assert {name: lines for name, text in MODULES.items() if (lines := text.count("\n")) > 300} == {}


def test_folders_hold_at_most_15_modules() -> None:
    folders = Counter(str(Path(name).parent) for name in MODULES if not name.endswith("__init__.py"))
    assert {name: modules for name, modules in folders.items() if modules > 15} == {}
