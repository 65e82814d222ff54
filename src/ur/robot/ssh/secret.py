"""A text that must not be displayed."""


class Secret:
    """A password. Only `reveal` returns its text: str, repr, formats and comparisons with a text do not reveal it."""

    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def reveal(self) -> str:
        """Return the text. Pass it to a pipe or a socket, never to a command line, environment, file or message."""
        return self._text

    def __repr__(self) -> str:
        return "Secret(...)"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Secret) and other._text == self._text

    def __hash__(self) -> int:
        return hash((Secret, self._text))
