"""Every regular expression of `src` takes time in proportion to a text of 64 kB of its own alphabet."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from tests.source.patterns import Pattern, find_slow_text, list_patterns

MADE = 31
"""The number of patterns that are made while a program runs, mostly of escaped names. Lower it where some leave."""


def test_no_pattern_takes_more_than_linear_time() -> None:
    command = [sys.executable, "-m", "tests.source.patterns"]
    done = subprocess.run(command, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert [line for line in lines if line.startswith("slow ")] == []
    assert len([line for line in lines if line.startswith("made ")]) == MADE
    assert int(lines[-1]) > 300


@pytest.mark.parametrize("pattern", [r"(a+)+\Z", r"[ab]+c", r"\s+#", r"\b(?P<a>eyJ[\w-]{8,}\.)", r"<!--.*?-->"])
def test_pattern_that_takes_longer_is_found(pattern: str) -> None:
    assert find_slow_text(Pattern(re.compile(pattern), frozenset({"search"})), 0.02, 16_384) is not None


@pytest.mark.parametrize("pattern", [r"(?<!a)a+c", r"<!--.*?(?:-->|\Z)", r"\s{0,100}#", r"a*b"[:2]])
def test_linear_pattern_is_not_found(pattern: str) -> None:
    assert find_slow_text(Pattern(re.compile(pattern), frozenset({"search"}))) is None


def test_patterns_are_those_of_literals_and_of_constants_in_them(tmp_path: Path) -> None:
    path = tmp_path / "a.py"
    path.write_text(
        "import re\n_NAME = r'[a-z]+'\n_ONE = re.compile(rf'{_NAME}=')\n"
        "def f(text):\n    return _ONE.match(text), re.sub('x', '', text), re.search(text, text)\n"
    )
    found = [(each.pattern.pattern if each.pattern else None, *each.methods) for each in list_patterns(path)]
    assert sorted(found, key=str) == [("[a-z]+=", "match"), ("x", "sub"), (None, "search")]
