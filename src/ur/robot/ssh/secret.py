"""A text that must not be seen."""

from __future__ import annotations


class Secret:
    """A password. Its text comes out of `reveal` only: not of str, repr, a format or a comparison with a text."""

    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def reveal(self) -> str:
        """The text itself. Hand it to a pipe or a socket, never to a command line, environment, file or message."""
        return self._text

    def __repr__(self) -> str:
        return "Secret(...)"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Secret) and other._text == self._text

    def __hash__(self) -> int:
        return hash((Secret, self._text))
