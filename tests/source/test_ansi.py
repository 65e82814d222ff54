import pytest

from ur.source.ansi import (
    BOLD,
    RED,
    RESET,
    allows_colour,
    cut_styled,
    is_plain,
    paint,
    speaks_unicode,
    strip_colours,
    strip_styles,
)


def test_painted_text_is_as_before_without_its_styles() -> None:
    assert paint("text", BOLD, RED) == "\x1b[1m\x1b[31mtext\x1b[0m"
    assert strip_styles(paint("text", BOLD, RED)) == "text"


def test_bold_and_reverse_stay_without_colours() -> None:
    assert strip_colours("\x1b[31;7;1mstopped\x1b[0m") == "\x1b[7;1mstopped\x1b[0m"
    assert strip_colours("\x1b[38;5;9mred\x1b[m") == "red\x1b[m"


@pytest.mark.parametrize(("columns", "shown"), [(0, ""), (2, "ab"), (3, "abc"), (9, "abcd")])
def test_line_is_cut_by_what_shows(columns: int, shown: str) -> None:
    cut = cut_styled(f"a{RED}bc{RESET}d", columns)
    assert strip_styles(cut) == shown
    assert cut.endswith(RESET)


@pytest.mark.parametrize(
    ("environment", "plain", "colour"),
    [
        ({"TERM": "xterm"}, False, True),
        ({"TERM": "xterm", "NO_COLOR": "1"}, False, False),
        ({"TERM": "xterm", "NO_COLOR": ""}, False, True),
        ({"TERM": "dumb"}, True, False),
        ({}, True, False),
    ],
)
def test_environment_decides_about_colours(environment: dict[str, str], plain: bool, colour: bool) -> None:
    assert (is_plain(environment), allows_colour(environment)) == (plain, colour)


def test_signs_beyond_ascii_are_for_locales_that_have_them() -> None:
    assert speaks_unicode("utf-8", {"LANG": "C"})
    assert not speaks_unicode("utf-8", {"LC_ALL": "C"})
    assert not speaks_unicode("iso-8859-1", {})
