"""No import circles: between modules none of any kind, between packages none of imports at the top."""

from collections import defaultdict
from collections.abc import Mapping, Set
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise

import pytest
from tests.form.facts import Facts, find_facts
from tests.form.test_layers import module_of

Imports = Mapping[str, str]
"""Imported modules with the kind of the import: `at the top`, `in a function`, `for types`."""


def find_imports(facts: Facts, known: Set[str]) -> Imports:
    found: dict[str, str] = {}
    for each in facts.imports:
        names = [name if (name := f"{each.module}.{inner}") in known else each.module for inner in each.names]
        for name in names or [each.module]:
            found[name] = min(found.get(name, each.kind), each.kind)  # alphabetical: the top comes first
    return found


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
def imports(modules: Mapping[str, Facts]) -> dict[str, Imports]:
    known = {*map(module_of, modules)}
    return {module_of(path): find_imports(each, known) for path, each in modules.items()}


def test_no_modules_import_one_another(imports: dict[str, Imports]) -> None:
    assert not (circle := find_circle(imports)), f"a circle: move what both need into a module below\n{circle}"


def test_no_packages_import_one_another(imports: dict[str, Imports]) -> None:
    found = find_package_circles(imports)
    assert not found, f"a circle {found}, expected imports in one direction: move what both need down"


def test_imports_in_functions_and_for_types_make_circles_too() -> None:
    deferred = find_imports(find_facts("def f():\n    import b\n"), {"b"})
    typed = find_imports(find_facts("if TYPE_CHECKING:\n    from c import C\n"), {"c"})
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
