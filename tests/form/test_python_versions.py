"""The oldest Python on which nodes and `ur` run: 3.10, that of Ubuntu 22.04 and of ROS 2 Humble.

mypy and ruff check this too, by the version in pyproject.toml; these tests say so, and need neither.
"""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
OLDEST = (3, 10)
LATER = {
    "asyncio": {"Barrier", "Runner", "TaskGroup", "timeout", "timeout_at"},
    "builtins": {"BaseExceptionGroup", "ExceptionGroup", "PythonFinalizationError"},
    "contextlib": {"chdir"},
    "datetime": {"UTC"},
    "enum": {"EnumType", "FlagBoundary", "ReprEnum", "StrEnum", "member", "nonmember", "property", "verify"},
    "hashlib": {"file_digest"},
    "inspect": {"getmembers_static", "markcoroutinefunction"},
    "itertools": {"batched"},
    "math": {"cbrt", "exp2", "fma", "sumprod"},
    "operator": {"call"},
    "os": {"process_cpu_count"},
    "sys": {"activate_stack_trampoline", "exception", "monitoring"},
    "tomllib": {""},
    "types": {"get_original_bases"},
    "typing": {"Never", "Self", "Unpack", "TypeVarTuple", "LiteralString", "NotRequired", "Required", "ReadOnly"}
    | {"TypeAliasType", "TypeIs", "assert_never", "assert_type", "clear_overloads", "dataclass_transform"}
    | {"get_overloads", "get_protocol_members", "is_protocol", "override", "reveal_type"},
    "warnings": {"deprecated"},
    "wsgiref": {"types"},
}
"""Names of the standard library that are newer than Python 3.10, by module; '': the module itself."""


def list_later(tree: ast.Module) -> Iterator[str]:
    """List the names of a module that Python 3.10 does not have."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and not node.level and node.module in LATER:
            names = {alias.name for alias in node.names} | {""}
            yield from (f"{node.module}.{name}" for name in names & LATER[node.module])
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if "" in LATER.get(alias.name, ()))
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.attr in LATER.get(node.value.id, ()):
                yield f"{node.value.id}.{node.attr}"
        elif isinstance(node, ast.Name) and node.id in LATER["builtins"]:
            yield node.id


def test_all_of_src_is_python_of_the_oldest_version() -> None:
    later = []
    for path in sorted((ROOT / "src").rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"), str(path), feature_version=OLDEST)
        later += [f"{path.relative_to(ROOT)}: {name}" for name in list_later(tree)]
    assert later == []


@pytest.mark.parametrize(
    "text",
    ["import tomllib", "from typing import Self", "import asyncio\nasyncio.timeout(1)", "raise ExceptionGroup('', [])"],
)
def test_name_that_is_newer_is_found(text: str) -> None:
    assert [*list_later(ast.parse(text))]


def test_newer_syntax_is_found() -> None:
    with pytest.raises(SyntaxError):
        ast.parse("try:\n    pass\nexcept* OSError:\n    pass", feature_version=OLDEST)


def test_tools_check_for_the_same_version() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    wanted = ['requires-python = ">=3.10"', 'target-version = "py310"', 'python_version = "3.10"']
    assert [each for each in wanted if not re.search(f"(?m)^{re.escape(each)}$", text)] == []
