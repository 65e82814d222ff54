"""Docstrings are contracts: a noun phrase or an imperative verb, never an indirect question."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.unmeasured  # reads sources; it runs none of them

SRC = Path(__file__).parents[1] / "src"
QUESTIONS = {
    *("What", "Which", "How", "Whether", "Who", "Whose", "Where", "Why", "When"),
    *("Is", "Are", "Has", "Can", "Does"),
}
MODULES = sorted(SRC.rglob("*.py"))


def docstrings_of(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            docstring = ast.get_docstring(node, clean=False)
            if docstring and docstring.strip():
                yield docstring


def test_no_docstring_begins_with_a_question_word() -> None:
    wrong = {
        path.relative_to(SRC).as_posix(): questions
        for path in MODULES
        if (questions := [each for each in docstrings_of(path) if each.split()[0].rstrip(",:") in QUESTIONS])
    }
    assert wrong == {}
