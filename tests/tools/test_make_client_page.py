"""The page of the Python library is that of its docstrings."""

import inspect
import runpy
from pathlib import Path

from ur_nodes.client import AsyncRobot, Robot

TOOL = runpy.run_path(str(Path(__file__).parents[2] / "tools" / "make_client_page.py"))


def test_page_is_that_of_the_docstrings() -> None:
    assert TOOL["PAGE"].read_text(encoding="utf-8") == TOOL["make_page"](), "run tools/make_client_page.py"


def test_both_robots_have_the_same_methods_and_arguments() -> None:
    def methods(kind: type) -> dict[str, list[str]]:
        functions = {name: each for name, each in vars(kind).items() if inspect.isfunction(each)}
        return {name: list(inspect.signature(each).parameters) for name, each in functions.items() if name[0] != "_"}

    without_tasks = {name: each for name, each in methods(Robot).items() if name != "interrupt"}
    assert methods(AsyncRobot) == without_tasks
