"""One budget for all that a file holds: many small pieces of work are refused like one large one."""

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.limits import run_limited

from ur.launchfile.load import load_plan
from ur.launchfile.plan.values.yaml_values import read_yaml
from ur.launchfile.world.memory import MemoryWorld

ROOT = Path(__file__).parents[3]
CPU_SECONDS, MEMORY_KB = 10, 200_000  # of `ur check` on one file


def rosparams(count: int, text: str) -> str:
    blocks = "".join(f"<rosparam ns='b{i}'>\nn: {i}\n{text}</rosparam>\n" for i in range(count))
    return f"<launch>\n{blocks}</launch>\n"


def aliases(depth: int) -> str:
    lines = ["a0: &amp;a0 {" + ", ".join(f"k{i}: 1" for i in range(10)) + "}"]
    lines += [
        f"a{n}: &amp;a{n} {{" + ", ".join(f"k{i}: *a{n - 1}" for i in range(10)) + "}" for n in range(1, depth + 1)
    ]
    return "\n".join(lines) + "\n"


ANGLE = "+".join(["1"] * 150)
FILES: dict[str, Callable[[], str]] = {
    "angles in many texts": lambda: rosparams(400, "".join(f"a{i}: rad({ANGLE})\n" for i in range(40))),
    "angles in many parameters": lambda: (
        "<launch>\n<rosparam>a: 1</rosparam>\n"
        + "".join(f"<param name='p{i}' type='yaml' value='rad({ANGLE})'/>\n" for i in range(20_000))
        + "</launch>\n"
    ),
    "aliases in many texts": lambda: rosparams(20, aliases(4)),
    "keys of one mapping": lambda: rosparams(1, "".join(f"key{i}: {i}\n" for i in range(400_000))),
    "keys of many mappings": lambda: rosparams(400, "".join(f"key{i}: deg({i})\n" for i in range(1000))),
    "quoted texts": lambda: rosparams(1, "".join(f"key{i}: 'a: {i}'\n" for i in range(200_000))),
}


@pytest.mark.parametrize("name", FILES)
def test_check_of_a_file_stays_within_its_bounds(tmp_path: Path, name: str) -> None:
    (tmp_path / "a.launch").write_text(FILES[name]())
    command = [sys.executable, "-I", "-m", "ur", "check", "a.launch"]
    used = run_limited(command, CPU_SECONDS, tmp_path, os.environ)
    assert used.code == 1, used.output[-500:]
    assert "takes too long" in used.output
    assert used.memory <= MEMORY_KB


def test_a_large_parameter_file_is_no_attack() -> None:
    text = rosparams(50, "".join(f"key{i}: {i}.5\n" for i in range(100)))
    plan = load_plan(["/a.launch"], [], MemoryWorld({"/a.launch": text}))
    assert not plan.diagnostics
    assert len(plan.params) == 50 * 101


def test_the_last_of_equal_keys_is_the_one_that_is_shown() -> None:
    start, _ = read_yaml("a: 1\nb: 2\n", reads_angles=True).place_of(("b",))
    assert start == len("a: 1\n")
    assert read_yaml("[a, b]", reads_angles=True).place_of(("a",)) == (0, 0)
