"""Text that bash inserts for a candidate: only the part that replaces typed text, with matching quotes."""

from __future__ import annotations

import re
from functools import lru_cache

from ur.complete.line import TypedWord, read_word, split_line

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
