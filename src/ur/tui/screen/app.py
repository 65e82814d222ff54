"""A Textual application whose caller reports its crash. To be imported only when a screen is shown."""

from typing import ClassVar, Generic, TypeVar

from textual.app import App
from textual.binding import Binding, BindingType

Result = TypeVar("Result")


class FullScreenApp(App[Result], Generic[Result]):
    """An application without Textual's command palette and without a traceback over the terminal."""

    ENABLE_COMMAND_PALETTE = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+z", "explain_suspension", "Suspend", priority=True, show=False)
    ]

    def action_explain_suspension(self) -> None:
        """Report that Ctrl-Z does not suspend the program: its robot would drive on unattended or stop."""
        self.notify("Ctrl-Z does not suspend this program; use another terminal beside it", timeout=4.0)

    @property
    def problem(self) -> Exception | None:
        """Return the exception that ended the application, for its caller to report."""
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
