from pathlib import Path

import pytest

from ur.source import SourceFile, Span, UserError
from ur.source.read import read_source


def test_position_counts_lines_and_characters_from_one() -> None:
    file = SourceFile("x", "ab\né☃\n")
    assert [file.position(offset) for offset in (0, 2, 3, 4, 6)] == [(1, 1), (1, 3), (2, 1), (2, 2), (3, 1)]


def test_line_has_no_line_break() -> None:
    file = SourceFile("x", "one\r\ntwo\n")
    assert [file.line(number) for number in (1, 2, 3)] == ["one", "two", ""]


def test_span_prints_where_it_starts() -> None:
    assert str(Span(SourceFile("dir/x", "a\nbc"), 3, 4)) == "dir/x:2:2"


def test_file_that_is_not_text_is_named(tmp_path: Path) -> None:
    (tmp_path / "x").write_bytes(b"ab\xff")
    with pytest.raises(UserError, match="byte 2 is not UTF-8"):
        read_source(tmp_path / "x")
    with pytest.raises(UserError, match="no such file"):
        read_source(tmp_path / "y")
