"""Text that bash inserts is the candidate again, once bash has read it."""

import subprocess

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur.complete.line import quote_insertion, read_word, split_line

SHELL = "".join(map(chr, range(0x20, 0x7F))) + "é漢"


@pytest.mark.parametrize(
    ("line", "replaced", "text", "inserted"),
    [
        ("ur check ", "", "y;touch X;.launch", "y\\;touch\\ X\\;.launch"),
        ("ur check y", "y", "y z", "y\\ z"),
        ("ur check 'y", "y", "y's", "y'\\''s"),
        ('ur check "y', "y", 'y$(a)`b`"c\\d!e', 'y\\$(a)\\`b\\`\\"c\\\\d"\'!\'"e'),
        ("ur launch x:=", "", "x:=a b", "a\\ b"),
        ("ur launch x:=a\\ ", "a\\ ", "x:=a b", "a\\ b"),
        ("ur check ~", "~", "~root", "\\~root"),
        ("ur check {", "{", "{a,b}", "\\{a,b\\}"),
        ("ur check x", "other", "xy", None),
        ("ur check 'x'", "", "y", None),
        ("ur check my\\ fi", None, "my file", "my\\ file"),
    ],
)
def test_insertion_is_quoted_as_the_text_around_it(line: str, replaced: str | None, text: str, inserted: str) -> None:
    assert quote_insertion(line, replaced, text) == inserted


@pytest.mark.parametrize("quote", ["", "'", '"'])
@settings(max_examples=60)
@given(name=st.text(SHELL, min_size=1))
def test_bash_reads_an_insertion_as_the_name(quote: str, name: str) -> None:
    inserted = quote_insertion(f"ur check {quote}", "", name)
    done = subprocess.run(
        ["bash", "-c", f"printf %s {quote}{inserted}{quote}"], capture_output=True, text=True, check=True
    )
    assert done.stdout == name
    assert (split_line(f"ur check {quote}{inserted}").prefix, read_word(f"{quote}{inserted}").quote) == (name, quote)
