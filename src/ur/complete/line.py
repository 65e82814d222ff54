"""A command line split as a shell does, also with open quotes."""

import re
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

from ur.complete.completions import Line


class TypedWord(NamedTuple):
    """An argument of a command line: its value, its typed form, and the open quote, if any."""

    text: str
    raw: str
    quote: str = ""


def split_line(text: str) -> Line:
    """Split the text before the cursor; the first word, the program itself, is left out."""
    *words, last = _scan(text)
    return Line(tuple(word.text for word in words[1:]), last.text if words else "", last.raw if words else "")


def read_word(raw: str) -> TypedWord:
    """Parse one argument, or the beginning of one."""
    return _read(raw, 0)


def _scan(line: str) -> Iterator[TypedWord]:
    position = 0
    while True:
        while position < len(line) and line[position].isspace():
            position += 1
        word = _read(line, position)
        yield word
        position += len(word.raw)
        if position == len(line):
            return


def _read(line: str, start: int) -> TypedWord:
    text, quote, position = "", "", start
    while position < len(line):
        character, after = line[position], line[position + 1 : position + 2]
        if not quote and character.isspace():
            break
        position += 1
        if quote and character == quote:
            quote = ""
        elif not quote and character in "'\"":
            quote = character
        elif character == "\\" and (not quote or (quote == '"' and after in '$`"\\')):
            text += after
            position += len(after)
        else:
            text += character
    return TypedWord(text, line[start:position], quote)


# Whatever may mean something to a shell, expansion of history, braces and ~ included. Letters of any language do not.
_UNQUOTED = re.compile(r"[^\w@%+=:,./-]")
_DOUBLE = re.compile(r'[$`"\\]')


def quote_insertion(line: str, replaced: str | None, text: str) -> str | None:
    """Return the text that replaces `replaced`, the end of `line`, so that the word becomes the candidate `text`.

    Bash replaces only a part of a word with `:` or `=`, or with an open quote, which bash closes. None if the candidate
    does not continue the remaining part. `replaced` is None for the whole last word.
    """
    kept = _find_kept(line, replaced)
    return _quote(text[len(kept.text) :], kept.quote) if kept and text.startswith(kept.text) else None


@lru_cache(maxsize=4)  # the same for each of thousands of candidates
def _find_kept(line: str, replaced: str | None) -> TypedWord | None:
    raw = split_line(line).raw
    replaced = raw if replaced is None else replaced
    return read_word(raw[: len(raw) - len(replaced)]) if raw.endswith(replaced) else None


def _quote(text: str, quote: str) -> str:
    if quote == "'":
        return text.replace("'", "'\\''")
    if quote == '"':
        # A backslash before ! would stay.
        return _DOUBLE.sub(lambda found: f"\\{found.group()}", text).replace("!", "\"'!'\"")
    return _UNQUOTED.sub(lambda found: f"\\{found.group()}", text)
