"""Nothing in the table of robots and sensors is tried that no test tries, and every name in it is known."""

import ast
import re
import runpy
from pathlib import Path
from typing import Any

import pytest

from ur.devices.known import find_rows
from ur.robot.base import load_base

ROOT = Path(__file__).parents[2]
SUPPORTED = runpy.run_path(str(ROOT / "tools" / "make_hardware_page.py"))["read_table"]()
LIBRARY = ROOT / "ubiquity_launches"


def test_table_names_a_dozen_robots_and_sensors_each_once() -> None:
    names = [each.name for each in SUPPORTED]
    assert len(names) == len(set(names)) >= 12


@pytest.mark.parametrize("each", SUPPORTED, ids=lambda each: each.name)
def test_every_trial_names_a_test_that_exists(each: Any) -> None:
    for trial in each.trials:
        file, _, function = trial.test.partition("::")
        tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
        functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert function in functions, trial


@pytest.mark.parametrize("each", SUPPORTED, ids=lambda each: each.name)
def test_nothing_is_untried_without_saying_so(each: Any) -> None:
    assert each.untried
    assert each.brings
    assert each.by_hand
    assert not any(trial.way == "hardware" for trial in each.trials), "then the page says so, too"


@pytest.mark.parametrize("each", SUPPORTED, ids=lambda each: each.name)
def test_devices_bases_and_programs_of_the_table_exist(each: Any) -> None:
    assert all(find_rows(device) for device in each.devices)
    for name in each.bases:
        base, _, variant = name.partition(":")
        load_base(LIBRARY, base, variant)
    for program in re.findall(r"`ur run (\w+)", each.command):
        assert (LIBRARY / "bin" / f"ur_{program}").is_file()
    for folder in re.findall(r"`(n_\w+)`", each.brings):
        assert (LIBRARY / folder).is_dir()
