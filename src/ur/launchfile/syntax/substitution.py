"""The small language inside attribute values: `$(find pkg)`, `$(arg name)`, `$(eval expression)` and others."""

from functools import lru_cache
from typing import NamedTuple

COMMANDS = ("find", "env", "optenv", "dirname", "anon", "arg")
_EVAL = "$(eval "


class SubstitutionProblem(Exception):  # noqa: N818 - carries a finding to where its place is known
    """An error in a `$(...)`.

    `start` and `end` are offsets in its value. `subject` and `kind` are as in a Diagnostic.
    """

    def __init__(
        self,
        message: str,
        start: int,
        end: int,
        rule: str = "bad-substitution",
        help: str | None = None,
        subject: str = "",
        kind: str = "",
    ) -> None:
        super().__init__(message)
        self.message = message
        self.start = start
        self.end = end
        self.rule = rule
        self.help = help
        self.subject = subject
        self.kind = kind


class SubstitutionWord(NamedTuple):
    """A word inside `$(...)` and its position in the value."""

    text: str
    start: int
    end: int


class Substitution(NamedTuple):
    """One `$(command word ...)`. `content` is the text between the parentheses; offsets include `$(` and `)`.

    `command` is not validated: see COMMANDS. For `$(eval ...)`, which is the whole value, `content` is the expression
    and `words` is empty.
    """

    command: str
    content: str
    words: tuple[SubstitutionWord, ...]
    start: int
    end: int


def is_eval(text: str) -> bool:
    """Return whether a value is one `$(eval ...)`: as in roslaunch, all text between its two ends is the expression."""
    return text.startswith(_EVAL) and text.endswith(")")


@lru_cache(maxsize=4096)
def parse_substitutions(text: str) -> tuple[Substitution, ...]:
    """Parse every `$(...)` in a value, in order, as roslaunch does. Raises SubstitutionProblem.

    `$$(` counts as `$(`; `$()` and an unclosed `$(` are plain text; they do not nest.
    """
    if is_eval(text):
        return (Substitution("eval", text[len(_EVAL) : -1], (), 0, len(text)),)
    found: list[Substitution] = []
    dollar = text.find("$")
    while dollar != -1:
        after = dollar + 1
        while text[after : after + 1] == "$":
            after += 1
        if text[after : after + 1] != "(":
            dollar = text.find("$", after)
            continue
        close = _content_end(text, after + 1)
        if close == -1:
            break
        if close > after + 1:
            start = after - 1
            content = text[start + 2 : close]
            words: list[SubstitutionWord] = []
            offset = start + 2
            for part in content.split(" "):
                if part:
                    words.append(SubstitutionWord(part, offset, offset + len(part)))
                offset += len(part) + 1
            command = words[0].text if words else ""
            found.append(Substitution(command, content, tuple(words[1:]), start, close + 1))
        dollar = text.find("$", close)
    return tuple(found)


def _content_end(text: str, start: int) -> int:
    # The offset of the closing parenthesis, -1 when there is none.
    for offset in range(start, len(text)):
        character = text[offset]
        if character == ")":
            return offset
        if character == "$":
            raise SubstitutionProblem(
                "'$' inside $(...), expected plain text: substitutions do not nest",
                offset,
                offset + 1,
                help="compute the inner part in an <arg value=...> of its own, or use $(eval ...)",
            )
        if character == "(":
            help_ = "$(eval ...) has to be the whole value, with nothing before or after it"
            raise SubstitutionProblem(
                "'(' inside $(...), expected ')'", offset, offset + 1, help=help_ if _EVAL in text else None
            )
    return -1
