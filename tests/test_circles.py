"""No import circles: between modules none of any kind, between packages none of imports at the top."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from pathlib import Path

import pytest
from tests.test_layers import MODULES

Imports = Mapping[str, str]
"""Imported modules with the kind of the import: `at the top`, `in a function`, `for types`."""


def find_imports(text: str) -> Imports:
    found: dict[str, str] = {}
    for node, kind in walk(ast.parse(text), "at the top"):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            names = [
                name if (name := f"{node.module}.{alias.name}") in MODULES else str(node.module) for alias in node.names
            ]
        for name in names:
            found[name] = min(found.get(name, kind), kind)  # alphabetical: the top comes first
    return found


def walk(node: ast.AST, kind: str) -> Iterator[tuple[ast.Import | ast.ImportFrom, str]]:
    for each in ast.iter_child_nodes(node):
        if isinstance(each, ast.Import | ast.ImportFrom):
            yield each, kind
        elif isinstance(each, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            yield from walk(each, "in a function")
        elif isinstance(each, ast.If) and "TYPE_CHECKING" in ast.unparse(each.test):
            yield from walk(each, "for types")
        else:
            yield from walk(each, kind)


def find_circle(imports: Mapping[str, Imports]) -> str:
    """A circle of modules, an import a line; '' without one."""
    graph = {name: [each for each in found if each in imports and each != name] for name, found in imports.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as problem:
        circle = list(reversed(problem.args[1]))
        pairs = pairwise(circle)
        return "\n".join(f"{one} imports {other} {imports[one][other]}" for one, other in pairs)
    return ""


def find_package_circles(imports: Mapping[str, Imports]) -> set[tuple[str, str]]:
    """The folders of each folder, and the modules beside them, that import one another at the top."""
    folders: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    for module, found in imports.items():
        for name, kind in found.items():
            if name in imports and kind == "at the top":
                above, one, other = part(module, name)
                if one and other:
                    folders[above][one].add(other)
    circles = set()
    for above, graph in folders.items():
        reached = {name: reach(graph, name) for name in graph}
        for name in graph:
            together = {other for other in reached[name] if name in reached.get(other, ())}
            if len(together) > 1:
                circles.add((above, " ".join(sorted(together))))
    return circles


def part(one: str, other: str) -> tuple[str, str, str]:
    """The folder that two modules share, and the folder or module in it through which each is reached."""
    names, others = one.split("."), other.split(".")
    depth = next((i for i, pair in enumerate(zip(names, others, strict=False)) if pair[0] != pair[1]), None)
    if depth is None:  # a package and a module in it
        return "", "", ""
    return ".".join(names[:depth]), names[depth], others[depth]


def reach(graph: Mapping[str, set[str]], start: str) -> set[str]:
    found: set[str] = set()
    waiting = [start]
    while waiting:
        waiting.extend(new := graph.get(waiting.pop(), set()) - found)
        found |= new
    return found


@pytest.fixture(scope="module")
def imports() -> dict[str, Imports]:
    return {module: find_imports(Path(path).read_text(encoding="utf-8")) for module, path in MODULES.items()}


def test_no_modules_import_one_another(imports: dict[str, Imports]) -> None:
    assert not (circle := find_circle(imports)), f"a circle: move what both need into a module below\n{circle}"


def test_no_packages_import_one_another(imports: dict[str, Imports]) -> None:
    found = find_package_circles(imports)
    assert not found, f"a circle {found}, expected imports in one direction: move what both need down"


def test_imports_in_functions_and_for_types_make_circles_too() -> None:
    deferred = find_imports("def f():\n    import b\n")
    typed = find_imports("if TYPE_CHECKING:\n    from c import C\n")
    assert find_circle({"a": deferred, "b": typed, "c": {"a": "at the top"}}).splitlines() == [
        "a imports b in a function",
        "b imports c for types",
        "c imports a at the top",
    ]
    assert find_circle({"a": deferred, "b": typed, "c": {}}) == ""


def test_circle_of_packages_needs_no_circle_of_modules() -> None:
    top = "at the top"
    imports = {"t.a.one": {"t.b.two": top}, "t.b.two": {}, "t.b.three": {"t.a.four": top}, "t.a.four": {}}
    assert find_circle(imports) == ""
    assert find_package_circles(imports) == {("t", "a b")}
