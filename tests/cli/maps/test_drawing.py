import numpy as np

from ur.cli.maps.maps import draw_lines
from ur.source.ansi import strip_styles

VALUES = np.full((40, 60), -1, np.int8)
VALUES[10:30, 10:50] = 0
VALUES[29, 10:50] = 100


def test_unknown_border_is_cut_off_and_walls_are_kept() -> None:
    lines = draw_lines(VALUES, 20, 20, colour=False)
    assert lines == ["#" * 20, *(["." * 20] * 4)]


def test_coloured_picture_has_the_same_size() -> None:
    lines = draw_lines(VALUES, 20, 20, colour=True)
    assert {len(strip_styles(line)) for line in lines} == {20}
    assert set("".join(map(strip_styles, lines))) <= {"▀", " "}


def test_map_without_anything_seen_has_no_picture() -> None:
    assert draw_lines(np.full((3, 3), -1, np.int8), 20, 20, colour=False) == []
