"""A Textual application whose caller reports its crash. Import it where a screen is about to be shown."""

from __future__ import annotations

from typing import Generic, TypeVar

from textual.app import App

Result = TypeVar("Result")


class FullScreenApp(App[Result], Generic[Result]):
    """An application without Textual's command palette and without a traceback over the terminal."""

    ENABLE_COMMAND_PALETTE = False

    @property
    def problem(self) -> Exception | None:
        """The exception that ended the application; whoever runs it reports it."""
        return self._exception

    def use_theme(self, *, light: bool) -> None:
        """Use Textual's theme for a light or a dark background."""
        self.theme = "textual-light" if light else "textual-dark"

    def _handle_exception(self, error: Exception) -> None:
        self._return_code = 1
        if self._exception is None:
            self._exception = error
            self._exception_event.set()
        self._close_messages_no_wait()
