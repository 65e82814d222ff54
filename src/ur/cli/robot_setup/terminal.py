"""The terminal for questions of `ur robot setup`."""

from __future__ import annotations

import sys
from typing import Protocol

import click


class SetupTerminal(Protocol):
    """Asks the user. `ask` and `confirm` may be called only if `is_there` returns true."""

    def is_there(self) -> bool:
        """Return whether a terminal is available for questions."""

    def ask(self, question: str, default: str | None, *, show_default: bool = True) -> str:
        """Ask for a text; an empty answer is the default, if there is one."""

    def confirm(self, question: str) -> bool:
        """Ask for yes or no; an empty answer is no."""


class OwnTerminal:
    """The terminal of this process. See SetupTerminal."""

    def is_there(self) -> bool:
        return sys.stdin.isatty()

    def ask(self, question: str, default: str | None, *, show_default: bool = True) -> str:
        answer: str = click.prompt(question, default=default, show_default=show_default)
        return answer

    def confirm(self, question: str) -> bool:
        return click.confirm(question, default=False)


TERMINAL = OwnTerminal()
