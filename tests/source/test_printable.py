"""Foreign text cannot act on a terminal."""

import io
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.source import SourceFile, Span
from ur.source.diagnostic import Note, error
from ur.source.printable import GuardedStream, printable, printable_lines
from ur.source.render import render_human

CLIPBOARD = "\x1b]52;c;cm0gLXJmIH4=\x07"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("keyboard_drive", "keyboard_drive"),
        ("grüße/漢字 😀", "grüße/漢字 😀"),
        ("a\x1b[2Jb", r"a\x1b[2Jb"),
        (CLIPBOARD, r"\x1b]52;c;cm0gLXJmIH4=\x07"),
        ("a\nerror: b", r"a\nerror: b"),
        ("a\r\tb", r"a\r\tb"),
        ("\x9b2J", r"\x9b2J"),
        ("a\u202eb", r"a\u202eb"),
        ("caf\udce9.launch", r"caf\udce9.launch"),
    ],
)
def test_field_shows_what_would_act(text: str, shown: str) -> None:
    assert printable(text) == shown


def test_lines_and_tabs_stay_in_a_text_of_several_lines() -> None:
    assert printable_lines(f"a\n\tb{CLIPBOARD}\r") == "a\n\tb\\x1b]52;c;cm0gLXJmIH4=\\x07\\r"


@given(st.text())
def test_nothing_that_acts_is_left(text: str) -> None:
    assert not [each for each in printable(text) if unicodedata.category(each) in ("Cc", "Cs", "Zl", "Zp")]
    assert not [each for each in printable_lines(text) if unicodedata.category(each) == "Cc" and each not in "\n\t"]
    assert printable(printable(text)) == printable(text)


@pytest.mark.parametrize("kept", ["\x1b[1;31mred\x1b[0m\n", "\r\x1b[K12 %", "\x1b[?25l\x1b[2A\x1b[2Kline", "a\tb\n"])
def test_guarded_stream_keeps_colours_and_moves(kept: str) -> None:
    stream = io.StringIO()
    assert GuardedStream(stream).write(kept) == len(kept)
    assert stream.getvalue() == kept


@pytest.mark.parametrize(
    "escaped", [CLIPBOARD, "\x1b]0;title\x07", "\x1b[6n", "\x1bc", "\x1bP+q\x1b\\", "\x9b6n", "\x07"]
)
def test_guarded_stream_escapes_what_answers_or_sets_something(escaped: str) -> None:
    stream = io.StringIO()
    guarded = GuardedStream(stream)
    guarded.write(f"before {escaped} after\n")
    guarded.writelines([escaped])
    text = stream.getvalue()
    assert text.startswith("before \\x")
    assert not {"\x1b", "\x07", "\x9b"} & set(text)


def test_guarded_stream_writes_bytes_that_are_no_text() -> None:
    inner = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
    guarded = GuardedStream(inner)
    guarded.write("\udce9\n")
    guarded.flush()
    assert inner.buffer.getvalue() == b"\\udce9\n"
    assert guarded.encoding == "utf-8"


def test_finding_is_as_many_lines_as_it_has_parts() -> None:
    path = "a\nb.launch:1:1: error: forged"
    file = SourceFile(path, f"<launch>{CLIPBOARD}\t<node/>\n")
    span = Span(file, file.text.index("<node"), len(file.text) - 1)
    found = error(f"no {CLIPBOARD}", span, rule="r", help="x\ny", notes=(Note("z\x1b[2J\n", span),))
    text = render_human([found])
    head, excerpt, caret, note, help_ = text.splitlines()
    assert head == rf"a\nb.launch:1:1: error: forged:1:{span.position.column}: error: no {printable(CLIPBOARD)} [r]"
    assert excerpt.index("<node") == caret.index("^")
    assert note.endswith(r"z\x1b[2J\n")
    assert help_ == r"  help: x\ny"
    assert "\x1b" not in text


@pytest.mark.parametrize("mode", ["\x1b[?1000h", "\x1b[?1006;1003h", "\x1b[?2004h", "\x1b[4h", "\x1b[?5h", "\x1b[20l"])
def test_open_stream_changes_no_mode_of_the_terminal(mode: str) -> None:
    written = io.StringIO()
    GuardedStream(written).write(f"a{mode}\x1b[?25l\x1b[1mb")
    assert written.getvalue() == f"a\\x1b{mode[1:]}\x1b[?25l\x1b[1mb"
