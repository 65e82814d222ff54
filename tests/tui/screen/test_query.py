import os

import pytest

from ur.tui.screen.query import ask_background, is_light, measure_terminal, typed_text


@pytest.mark.parametrize(
    ("answer", "light"),
    [
        (b"\x1b]11;rgb:0000/0000/0000\x1b\\\x1b[?62c", False),
        (b"\x1b]11;rgb:ffff/ffff/ffff\x07\x1b[?62c", True),
        (b"\x1b]11;rgb:fd/f6/e3\x1b\\", True),
        (b"\x1b]11;rgb:0000/2b2b/3636\x1b\\", False),
        (b"\x1b]11;rgb:f/f/f\x07", True),
    ],
)
def test_background_is_read_from_the_terminals_answer(answer: bytes, light: bool) -> None:
    assert is_light({"COLORFGBG": "15;0" if light else "0;15"}, answer) is light


@pytest.mark.parametrize("answer", [b"\x1b[?62;22c", b"rubbish", b""])
def test_terminal_that_does_not_answer_may_have_set_colorfgbg(answer: bytes) -> None:
    assert is_light({"COLORFGBG": "0;15"}, answer)
    assert not is_light({"COLORFGBG": "15;0"}, answer)
    assert not is_light({}, answer)


def test_what_is_no_terminal_has_no_size_and_no_background() -> None:
    reader, writer = os.pipe()
    try:
        assert measure_terminal(writer) is None
        assert ask_background(reader, writer) == b""
    finally:
        os.close(reader)
        os.close(writer)


def test_what_was_typed_before_the_terminal_answered_is_kept() -> None:
    assert typed_text(b"g 1 2\n\x1b]11;rgb:0000/0000/0000\x1b\\\x1b[?62cg 3\x1b[A\x07") == "g 1 2\ng 3"
