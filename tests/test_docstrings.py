"""Docstrings are contracts: a noun phrase or an imperative verb, never an indirect question.

A method that implements a documented one needs none of its own: its contract is that of the protocol.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

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


def public_methods_of(path: Path) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    for each in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(each, ast.ClassDef) and not each.name.startswith("_"):
            for method in each.body:
                if isinstance(method, ast.FunctionDef | ast.AsyncFunctionDef) and not method.name.startswith("_"):
                    yield method


def test_public_methods_have_a_docstring_or_implement_one_that_has() -> None:
    methods = [(path, each) for path in MODULES for each in public_methods_of(path)]
    documented = {each.name for _, each in methods if ast.get_docstring(each)}
    visitors = {f"visit_{name}" for name in dir(ast)}  # documented by Python
    known = documented | visitors
    assert [f"{path.relative_to(SRC)} {each.name}" for path, each in methods if each.name not in known] == []


def test_no_docstring_begins_with_a_question_word() -> None:
    wrong = {
        path.relative_to(SRC).as_posix(): questions
        for path in MODULES
        if (questions := [each for each in docstrings_of(path) if each.split()[0].rstrip(",:") in QUESTIONS])
    }
    assert wrong == {}
