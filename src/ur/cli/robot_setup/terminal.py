"""The terminal at which `ur robot setup` asks."""

from __future__ import annotations

import sys
from typing import Protocol

import click


class SetupTerminal(Protocol):
    """Asks a person. `ask` and `confirm` are called only where it `is_there`."""

    def is_there(self) -> bool:
        """Return whether a person can be asked."""

    def ask(self, question: str, default: str | None, *, show_default: bool = True) -> str:
        """Ask for a text; an empty answer is the default, where there is one."""

    def confirm(self, question: str) -> bool:
        """Ask for yes or no; an empty answer is no."""


class OwnTerminal:
    """The terminal of this process. See SetupTerminal."""

    def is_there(self) -> bool:
        """See SetupTerminal."""
        return sys.stdin.isatty()

    def ask(self, question: str, default: str | None, *, show_default: bool = True) -> str:
        """See SetupTerminal."""
        answer: str = click.prompt(question, default=default, show_default=show_default)
        return answer

    def confirm(self, question: str) -> bool:
        """See SetupTerminal."""
        return click.confirm(question, default=False)


TERMINAL = OwnTerminal()
