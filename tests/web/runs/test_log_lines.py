import os
from pathlib import Path

from ur.web.runs.watcher import LogLines, read_lines


def test_page_continues_where_it_was_and_learns_what_it_has_missed() -> None:
    lines = LogLines(kept=3)
    for number in range(5):
        lines.add("/talk", "info", f"line {number}")
    first, found = lines.since(0, 10)
    assert (first, [each.text for each in found]) == (2, ["line 2", "line 3", "line 4"])
    assert lines.since(4, 10)[0] == 4
    assert lines.since(2, 1)[1][0].text == "line 2"
    assert lines.since(5, 10) == (5, [])
    assert lines.since(99, 10) == (5, [])


def test_colours_are_removed_and_control_characters_shown() -> None:
    lines = LogLines()
    lines.add("/talk", "", "\x1b[31mred\x1b[0m\tand \x07 bell" + 2000 * "x")
    (line,) = lines.since(0, 1)[1]
    assert line.text.startswith("red    and \\x07 bell")
    assert len(line.text) == 1000


def test_tail_of_a_log_begins_and_ends_with_a_whole_line_and_is_continued_there(tmp_path: Path) -> None:
    log = tmp_path / "log"
    log.write_text("".join(f"line {number}\n" for number in range(10000)) + "begun")
    tail, end = read_lines(str(log))
    assert tail[-1] == "line 9999"
    assert tail[0] == f"line {10000 - len(tail)}"
    with log.open("a") as file:
        file.write(" and ended\nmore")
    assert read_lines(str(log), end)[0] == ["begun and ended"]
    log.write_text("anew\n")
    assert read_lines(str(log), end)[0] == ["anew"]


def test_what_is_no_file_has_no_lines(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "missing", tmp_path / "pipe", tmp_path):
        assert read_lines(str(path)) == ([], 0)
