import re

import pytest

pytest.importorskip("segno", reason="segno is not installed: requirements/web.lock")

from ur.web.server.links import draw_code

LINK = "http://192.168.100.200:8090/login#" + "x" * 24


def test_code_fits_a_terminal_and_is_framed_by_light() -> None:
    lines = draw_code(LINK, colours=False).splitlines()
    assert len(lines) <= 24
    assert len({len(line) for line in lines}) == 1
    assert len(lines[0]) <= 80
    assert set(lines[0]) == {"█"}
    assert re.fullmatch(r"[█▀▄ \n]+", "\n".join(lines))


def test_code_with_colours_is_black_on_white() -> None:
    for line in draw_code(LINK, colours=True).splitlines():
        assert line.startswith("\x1b[97;40m")
        assert line.endswith("\x1b[0m")
