"""Answers to requests of pages: `ok` and `text`, and `value` where a form needs it."""

from collections.abc import Callable, Mapping

from ur.source.printable import printable

Fields = Mapping[str, object]
Answer = Callable[[Fields], None]
"""Passes an answer on, once."""


class RefusedError(Exception):
    """A request is refused; the text is the reason, on one line."""


def refuse(text: str) -> Fields:
    """Return the answer to a request that is refused."""
    return {"ok": False, "text": printable(text)[:1000]}


def refuse_uninstalled(type_name: str) -> RefusedError:
    """Return the refusal of a message type whose package is not installed."""
    return RefusedError(f"{type_name} is not installed on this computer, expected its package")


def attempt(job: Callable[[], Fields]) -> Fields:
    """Return the answer of a job, or its failure as a refusal: a master may answer anything."""
    try:
        return job()
    except Exception as problem:
        return refuse(str(problem))
