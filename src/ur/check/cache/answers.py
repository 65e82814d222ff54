"""Digests of a world's answers: answers with equal digests lead to the same findings."""

import hashlib
from collections.abc import Callable, Set

from ur.check.worlds import QUESTIONS, Question

CHECKED = "checked"  # PATH: whether it is among the checked files, and as what; answered by the check itself
ENVIRONMENT = "environment"  # NAME
_WORDS = {"package_names": 0, "find_in_package": 2, "find_files": 2, "find_executables": 2}
_KINDS = QUESTIONS | {CHECKED, ENVIRONMENT}
_SIZE = 12  # bytes of a digest


class Answers:
    """Digests of answers to queries, each computed once."""

    def __init__(self, answer: Callable[[Question], object]) -> None:
        self._answer = answer
        self._digests: dict[Question, str] = {}

    def digest_of(self, question: Question) -> str:
        """Return the digest of the answer to a query, computed on its first use."""
        if question not in self._digests:
            self._digests[question] = digest_of(self._answer(question))
        return self._digests[question]


def is_question(words: tuple[str, ...]) -> bool:
    """Return whether texts from a file are a valid query to a world."""
    return words[0] in _KINDS and len(words) == 1 + _WORDS.get(words[0], 1)


def digest_of(answer: object) -> str:
    """Return a digest of bytes, a text, a number, None, an exception, or a tuple, list or set of texts.

    Sets are sorted first; of an exception, its class, numbers and texts count. Raises TypeError for other types.
    """
    return hashlib.blake2b(_bytes_of(answer), digest_size=_SIZE).hexdigest()


def _bytes_of(answer: object) -> bytes:
    if isinstance(answer, bytes):
        return b"bytes:" + answer
    if isinstance(answer, Exception):
        answer = (type(answer).__name__, *map(str, answer.args), str(answer))
    elif isinstance(answer, Set):
        answer = ("set", *sorted(answer))
    elif not isinstance(answer, str | int | tuple | list | None):
        raise TypeError(f"{type(answer).__name__} is not what a world answers")
    return repr(answer).encode("utf-8", "backslashreplace")
