"""Names of classes are unique: a name tells which class is meant, wherever it is read."""

from __future__ import annotations

import ast
from collections import defaultdict
from pathlib import Path

TESTS = Path(__file__).parent
SRC = TESTS.parent / "src"
# The two backends have the same modules with the same classes, so that one is read beside the other.
BACKENDS = ({"ur_nodes/ros1", "ur_nodes/ros2"},)


def find_repeated(top: Path) -> dict[str, list[str]]:
    """The folders of classes whose name stands more than once below `top`, by name."""
    folders: dict[str, list[str]] = defaultdict(list)
    for path in sorted(top.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            # A name that begins with an underscore is read in its module only.
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                folders[node.name].append(path.parent.relative_to(top).as_posix())
    return {name: each for name, each in folders.items() if len(each) > 1}


def test_names_of_classes_are_unique() -> None:
    repeated = find_repeated(SRC)
    assert not {name: each for name, each in repeated.items() if len(each) > 2 or set(each) not in BACKENDS}


def test_what_stands_in_for_a_thing_in_tests_is_written_once() -> None:
    assert not find_repeated(TESTS), "use the one of tests/fakes, or name what is another thing after that"


def test_no_module_is_named_model() -> None:
    assert not list(SRC.rglob("model.py")), "expected a name for what the module holds"
