"""The computers of the test bench have no network: what a set-up installs must be on them, or be offered there."""

from __future__ import annotations

from pathlib import Path

import pytest

from ur.robot.setup import here, there

BENCH = Path(__file__).parents[2] / "hosts" / "bench"


@pytest.mark.parametrize("wanted", [here.PACKAGES, there.PACKAGES], ids=["viewer", "robot"])
def test_bench_has_or_offers_all_that_a_setup_installs(wanted: tuple[str, ...]) -> None:
    known = {line for name in ("packages.txt", "offered.txt") for line in (BENCH / name).read_text().splitlines()}
    assert [entry for entry in wanted if known.isdisjoint(entry.split("|"))] == []
