"""A command line as a shell splits it, also while quotes are still open."""

from __future__ import annotations

from ur.complete.model import Line


def split_line(text: str) -> Line:
    """Split what stands before the cursor; the first word, the program itself, is left out."""
    words: list[str] = []
    word: str | None = None
    quote = ""
    characters = iter(text)
    for character in characters:
        if quote:
            if character == quote:
                quote = ""
            elif character == "\\" and quote == '"':
                word = (word or "") + next(characters, "")
            else:
                word = (word or "") + character
        elif character in "'\"":
            quote = character
            word = word or ""
        elif character == "\\":
            word = (word or "") + next(characters, "")
        elif character.isspace():
            if word is not None:
                words.append(word)
            word = None
        else:
            word = (word or "") + character
    return Line(tuple(words[1:]), (word or "") if words else "")
