"""Reports of progress: pure code reports its steps, and its caller decides how to show them."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import TypeVar

Progress = Callable[[str], None]  # takes what is being done now: "checking 120 of 300 files"
Waiting = Callable[[str], AbstractContextManager[object]]  # opened around a wait: "waiting for bob to answer"
_Item = TypeVar("_Item")


def no_progress(text: str) -> None:
    """Ignore a report, for callers that show none."""


def no_waiting(text: str) -> AbstractContextManager[object]:  # noqa: ARG001 - as Waiting has it
    """Return a context that shows nothing."""
    return nullcontext()


def counted(items: Sequence[_Item], verb: str, noun: str, progress: Progress) -> Iterator[_Item]:
    """Yield the items, each reported before its use: "checking 120 of 300 files"."""
    total = len(items)
    for number, item in enumerate(items, 1):
        progress(f"{verb} {number} of {total} {noun}")
        yield item
