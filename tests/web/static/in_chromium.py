"""Marks of tests that need a real browser."""

import pytest
from tests.chromium import find_chromium

PROGRAM = find_chromium()
MARKS = [
    pytest.mark.timeout(240),
    pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed"),
]
