"""Facts of all Python files, read once for the tests of this folder, which one process runs: see tests/parallel.py."""

from collections.abc import Mapping

import pytest
from tests.form.facts import Facts, read_facts


@pytest.fixture(scope="package")
def facts() -> Mapping[str, Facts]:
    """The facts of src, tests, bench and tools, by path."""
    return read_facts()


@pytest.fixture(scope="package")
def modules(facts: Mapping[str, Facts]) -> Mapping[str, Facts]:
    """The facts of src, by path below it."""
    return {name.removeprefix("src/"): each for name, each in facts.items() if name.startswith("src/")}
