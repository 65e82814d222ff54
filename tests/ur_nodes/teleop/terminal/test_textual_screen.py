from __future__ import annotations

import pytest

from ur_nodes.teleop.terminal.textual_screen import is_light, parse_background


@pytest.mark.parametrize(
    ("answer", "light"),
    [
        (b"\x1b]11;rgb:0000/0000/0000\x1b\\\x1b[?62c", False),
        (b"\x1b]11;rgb:ffff/ffff/ffff\x07\x1b[?62c", True),
        (b"\x1b]11;rgb:fd/f6/e3\x1b\\", True),
        (b"\x1b]11;rgb:0000/2b2b/3636\x1b\\", False),
        (b"\x1b[?62;22c", None),
        (b"", None),
    ],
)
def test_background_is_read_from_the_terminals_answer(answer: bytes, light: bool | None) -> None:
    assert parse_background(answer) is light


def test_terminal_that_does_not_answer_may_have_set_colorfgbg() -> None:
    assert is_light({"COLORFGBG": "0;15"}, lambda: None)
    assert not is_light({"COLORFGBG": "15;0"}, lambda: None)
    assert not is_light({}, lambda: None)
    assert not is_light({"COLORFGBG": "0;15"}, lambda: False)
