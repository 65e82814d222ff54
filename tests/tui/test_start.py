from __future__ import annotations

from typing import Any

import pytest

from ur.tui.background import is_light
from ur.tui.start import choose_mode

USUAL: dict[str, Any] = {"terminal": True, "size": (80, 24), "term": "xterm", "calm": False, "textual": True}


@pytest.mark.parametrize(("changes", "mode"), [
    ({}, "full"),
    ({"size": (60, 15)}, "full"),
    ({"size": (59, 15)}, "calm"),
    ({"size": (60, 14)}, "calm"),
    ({"calm": True}, "calm"),
    ({"textual": False}, "calm"),
    ({"terminal": False, "calm": True}, "plain"),
    ({"term": "dumb"}, "plain"),
    ({"term": ""}, "plain"),
])  # fmt: skip
def test_mode_suits_the_terminal(changes: dict[str, Any], mode: str) -> None:
    assert choose_mode(**{**USUAL, **changes}) == mode


@pytest.mark.parametrize(("environment", "answer", "light"), [
    ({}, b"", False),
    ({"COLORFGBG": "0;15"}, b"", True),
    ({"COLORFGBG": "15;0"}, b"", False),
    ({"COLORFGBG": "0;15"}, b"\x1b]11;rgb:0000/0000/0000\x1b\\\x1b[?1;2c", False),
    ({}, b"\x1b]11;rgb:ffff/fafa/f0f0\x07\x1b[?62c", True),
    ({}, b"\x1b]11;rgb:f/f/f\x07", True),
    ({}, b"rubbish", False),
])  # fmt: skip
def test_background_is_as_the_terminal_says_else_as_its_environment(
    environment: dict[str, str], answer: bytes, light: bool
) -> None:
    assert is_light(environment, answer) == light
