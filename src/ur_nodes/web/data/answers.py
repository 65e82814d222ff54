"""Answers to requests of pages: `ok` and `text`, and `value` where a form needs it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ur.source.printable import printable

Fields = Mapping[str, object]
Answer = Callable[[Fields], None]
"""Passes an answer on, once."""


class RefusedError(Exception):
    """A request that is not carried out; the text is the reason, in a line."""


def refuse(text: str) -> Fields:
    """The answer to a request that is not carried out."""
    return {"ok": False, "text": printable(text)[:1000]}


def refuse_uninstalled(type_name: str) -> RefusedError:
    """The reason why messages of a type are not known."""
    return RefusedError(f"{type_name} is not installed on this computer, expected its package")


def attempt(job: Callable[[], Fields]) -> Fields:
    """The answer of a job, or why it has none: it may ask a master, which answers anything."""
    try:
        return job()
    except Exception as problem:
        return refuse(str(problem))
