"""The interface on a large enough terminal, with the actions that change the run: nodes, the run, debuggers."""

from collections.abc import Callable
from typing import ClassVar

from textual.binding import BindingType

from ur.run.clients.protocol import RunCommand, StopRun
from ur.run.clients.run_state import NodeRow
from ur.run.supervisor.events import CTRL_C, KillNode, RestartNode, StartNode, StopNode
from ur.tui.dialogs import DialogAnswer, Question
from ur.tui.keys import make_bindings
from ur.tui.log_actions import LogActions


class WatchApp(LogActions):
    """Shows and controls one run. It ends with the run, or with `detached` while the run continues."""

    BINDINGS: ClassVar[list[BindingType]] = make_bindings()

    _stops = 0

    def action_start(self) -> None:
        """Start a node."""
        self._command(StartNode, "start")

    def action_stop(self) -> None:
        """Stop a node and keep it stopped."""
        self._command(StopNode, "stop")

    def action_restart(self) -> None:
        """Stop a node and start it again."""
        self._command(RestartNode, "restart")

    def action_kill(self) -> None:
        """SIGKILL a node after confirmation."""
        row = self._steerable()
        if row is None:
            return

        def answer(key: str | None) -> None:
            if key == "k":
                self._send(KillNode(row.name), f"kill {row.name}")

        choices = (DialogAnswer("k", "kill it at once; it is kept stopped"),)
        self.push_screen(Question(f"Kill {row.name}?", choices, self.palette), answer)

    def action_debug(self) -> None:
        """Debug a node: gdb on a program that runs."""
        row = self._steerable()
        if row is None:
            return
        found = self.services.debug(row)
        if isinstance(found, str):
            self.show_notice(found)
        else:
            self.report(self.services.run_here(found.argv) if found.here else self.services.run_beside(found.argv))

    def action_stop_all(self) -> None:
        """End the run after confirmation."""
        self._ask_end(detach=False)

    def action_leave(self, _anyway: bool = False) -> None:
        """Quit: end the run, or only this interface if the run continues without it."""
        if not isinstance(self.screen, Question):
            self._ask_end(detach=self._may_leave)

    @property
    def _may_leave(self) -> bool:
        return self.guest or self.state.run.detached

    def _ask_end(self, *, detach: bool) -> None:
        def answer(key: str | None) -> None:
            if key == "s":
                self._stop_run()
            elif key == "d":
                self.exit("detached")

        choices = [DialogAnswer("s", "stop everything")]
        if detach:
            choices.append(DialogAnswer("d", "detach: leave, everything goes on"))
        title = f"Leave {self.state.run.title}?" if detach else f"Stop {self.state.run.title or 'everything'}?"
        self.push_screen(Question(title, tuple(choices), self.palette), answer)

    def action_interrupt(self) -> None:
        """Handle Ctrl-C: end the run immediately, as without an interface; for a detached run only ask."""
        if self._may_leave and not self._stops:
            self.action_leave()
        else:
            self._stop_run()

    def _stop_run(self) -> None:
        self._stops += 1
        self._send(StopRun(CTRL_C if self._stops == 1 else f"{CTRL_C} again"), "stopping everything")

    def _steerable(self) -> NodeRow | None:
        row = self.nodes.chosen
        if row is not None and row.changed.core:
            self.show_notice(f"{row.name} belongs to the run itself: it starts first and stops last")
            return None
        return row

    def _command(self, make: Callable[[str], RunCommand], word: str) -> None:
        row = self._steerable()
        if row is not None:
            self._send(make(row.name), f"{word} {row.name}")

    def _send(self, command: RunCommand, text: str) -> None:
        self.control.send(command)
        self.show_notice(text)
