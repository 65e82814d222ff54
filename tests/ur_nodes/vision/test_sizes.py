from __future__ import annotations

import pytest

from ur_nodes.vision.sizes import parse_numbers, parse_sizes


def test_numbers_and_ranges_are_read() -> None:
    assert parse_numbers("") == frozenset()
    assert parse_numbers(" 3, 7-9 ,") == {3, 7, 8, 9}


def test_sizes_are_read_for_numbers_and_ranges() -> None:
    assert parse_sizes("3: 0.2, 7-8:0.1") == {3: 0.2, 7: 0.1, 8: 0.1}


@pytest.mark.parametrize("text", ["3", "3: 0", "3: -1", "x: 0.2", "3: wide", "1-: 0.2"])
def test_sizes_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r".+"):
        parse_sizes(text)
