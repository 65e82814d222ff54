"""One implementation of a thing: no function of src, and none of the tests, stands in two modules."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

TESTS = Path(__file__).parent
SRC = TESTS.parent / "src"
LEAST = 3  # lines of a body; shorter ones are alike by chance


def body_of(node: ast.FunctionDef | ast.AsyncFunctionDef) -> str:
    """The statements of a function without its docstring, one form for each spelling."""
    statements = node.body[1:] if ast.get_docstring(node) is not None else node.body
    text = "\n".join(ast.unparse(each) for each in statements)
    return f"{ast.unparse(node.args)}\n{text}" if text.count("\n") + 1 >= LEAST else ""


def find_doubles(texts: dict[str, str], *, methods: bool = False) -> dict[str, list[str]]:
    """Functions at the top of modules, and `methods`, with the same arguments and the same body, by body."""
    places: dict[str, list[str]] = defaultdict(list)
    for name, text in texts.items():
        tree = ast.parse(text)
        for node in ast.walk(tree) if methods else tree.body:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and (body := body_of(node)):
                places[body].append(f"{name} {node.name}")
    return {body: found for body, found in places.items() if len(found) > 1}


def test_no_function_stands_in_two_modules() -> None:
    texts = {path.relative_to(SRC).as_posix(): path.read_text(encoding="utf-8") for path in SRC.rglob("*.py")}
    assert list(find_doubles(texts).values()) == [], "move it into a module below both, and import it"


def test_no_function_and_no_method_of_tests_stands_in_two_modules() -> None:
    texts = {path.relative_to(TESTS).as_posix(): path.read_text(encoding="utf-8") for path in TESTS.rglob("*.py")}
    found = [each for each in find_doubles(texts, methods=True).values() if len({name.split()[0] for name in each}) > 1]
    assert found == [], "move it to tests/fakes, or to the conftest.py of the folder that both are in"


def test_doubles_are_found_whatever_their_names_and_docstrings() -> None:
    one = 'def f(x: int) -> int:\n    """One."""\n    y = x\n    y += 1\n    return y\n'
    other = "def g(x: int) -> int:\n    y = x\n    y += 1\n    return y\n"
    assert list(find_doubles({"a": one, "b": other}).values()) == [["a f", "b g"]]
    assert (
        find_doubles({"a": "def f(x: int) -> int:\n    return x\n", "b": "def g(x: int) -> int:\n    return x\n"}) == {}
    )
