"""The tables of docs/reference/ros2.md are those of the code."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/reference/ros2.md").read_text(encoding="utf-8")


def rows(text: str, after: str) -> list[list[str]]:
    """The cells of the first table of a text after a mark, without its head."""
    lines = text.partition(after)[2].splitlines()
    table = lines[next(n for n, line in enumerate(lines) if line.startswith("|")) :]
    end = next((n for n, line in enumerate(table) if not line.startswith("|")), len(table))
    return [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in table[2:end]]


def test_page_has_the_names_of_ros_2() -> None:
    source = (ROOT / "src/ur_nodes/ports/raw.py").read_text(encoding="utf-8")
    assignment = next(
        node
        for node in ast.parse(source).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "UPSTREAM"
    )
    names = eval(compile(ast.Expression(assignment.value), "names", "eval"))
    table = {ours.strip("`"): theirs.strip("`") for ours, theirs in rows(PAGE, "<!-- names:")}
    assert table == names


def test_page_has_the_qualities_of_the_backend() -> None:
    source = (ROOT / "src/ur_nodes/ros2/qualities.py").read_text(encoding="utf-8")
    assert rows(PAGE, "<!-- qualities:") == rows(ast.get_docstring(ast.parse(source)) or "", "RViz 2.")
