import numpy as np

from ur.tui.screen.half_blocks import Glyph, cells_of_pixels

RED, BLUE = (255, 0, 0), (0, 0, 255)


def picture(*rows: list[tuple[int, int, int]]) -> np.ndarray[tuple[int, ...], np.dtype[np.uint8]]:
    return np.array(rows, dtype=np.uint8)


def test_two_pixels_become_one_cell_and_equal_cells_one_run() -> None:
    lines = cells_of_pixels(picture([RED, RED, BLUE], [BLUE, BLUE, BLUE]))
    assert lines == [(("▀▀", RED, BLUE), (" ", BLUE, BLUE))]


def test_glyph_stands_on_the_mean_of_its_pixels() -> None:
    lines = cells_of_pixels(picture([RED, RED, RED], [BLUE, BLUE, BLUE]), [Glyph(1, 0, "x", (9, 9, 9))])
    assert lines == [(("▀", RED, BLUE), ("x", (9, 9, 9), (127, 0, 127)), ("▀", RED, BLUE))]


def test_glyph_with_its_own_ground_and_last_glyph_wins() -> None:
    glyphs = [Glyph(0, 0, "a", RED), Glyph(0, 0, "b", RED, BLUE)]
    assert cells_of_pixels(picture([RED], [RED]), glyphs) == [(("b", RED, BLUE),)]


def test_odd_row_is_left_out_and_nothing_is_nothing() -> None:
    assert len(cells_of_pixels(picture([RED], [RED], [BLUE]))) == 1
    assert cells_of_pixels(np.zeros((0, 0, 3), np.uint8)) == []
