"""Splitting what stands before the cursor."""

import pytest

from ur.complete.line import split_line


@pytest.mark.parametrize(
    ("text", "words", "prefix"),
    [
        ("ur ", (), ""),
        ("ur la", (), "la"),
        ("ur launch  a.launch x:=1 ", ("launch", "a.launch", "x:=1"), ""),
        ("ur launch 'my file.launch' x:='a b", ("launch", "my file.launch"), "x:=a b"),
        ('ur run a "b\\"c', ("run", "a"), 'b"c'),
        ("ur run my\\ pro", ("run",), "my pro"),
        ("ur run ''", ("run",), ""),
        ("", (), ""),
    ],
)
def test_line_is_split_as_the_shell_does(text: str, words: tuple[str, ...], prefix: str) -> None:
    assert split_line(text)[:2] == (words, prefix)
