from typing import Any

import pytest

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
