"""Keys that change the display: the cursor, the log and its filter, pages to read."""

from dataclasses import replace

from textual.containers import VerticalScroll
from textual.widgets import Input

from ur.tui.dialogs import TextDialog, read_page
from ur.tui.keys import describe_keys
from ur.tui.run_screen import RANKS, RunScreen


class LogActions(RunScreen):
    """The actions that change the display."""

    def action_move(self, by: int) -> None:
        """Move the cursor to another node."""
        self.nodes.move(by)
        if self.log_view.filter.node:
            self._filter_node()

    def action_page(self, by: int) -> None:
        """Scroll the log by a page."""
        if isinstance(self.screen, TextDialog):
            scroll = self.screen.query_one(VerticalScroll)
            scroll.scroll_relative(y=by * max(1, scroll.size.height - 1), animate=False)
            return
        step = by * max(1, self.log_view.size.height - 1)
        self.log_view.scroll_relative(y=step, animate=False, immediate=True)
        self.call_after_refresh(self.draw)

    def action_oldest(self) -> None:
        """Scroll to the beginning of the log."""
        self.log_view.scroll_home(animate=False, immediate=True)
        self.call_after_refresh(self.draw)

    def action_newest(self) -> None:
        """Scroll to the end of the log, and follow it."""
        self.log_view.scroll_to_end()
        self.call_after_refresh(self.draw)

    def action_find(self) -> None:
        """Ask for a text to search."""
        field = self.query_one("#find", Input)
        field.display = True
        field.value = self.log_view.filter.text
        self.set_focus(field)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Apply the search text while typing."""
        self._filter(text=event.value)

    def on_input_submitted(self) -> None:
        """Keep the search text."""
        self._close_find(keep=True)

    def _close_find(self, *, keep: bool) -> None:
        field = self.query_one("#find", Input)
        if not keep:
            field.value = ""
            self._filter(text="")
        field.display = False
        self.set_focus(None)

    def action_only_node(self) -> None:
        """Show only the node under the cursor, or all nodes again."""
        if self.log_view.filter.node:
            self._filter(node="")
        else:
            self._filter_node()

    def _filter_node(self) -> None:
        row = self.nodes.chosen
        self._filter(node=row.name if row else "")

    def action_severity(self) -> None:
        """Switch between everything, warnings, and errors."""
        ranks = [rank for rank, _ in RANKS]
        self.rank = ranks[(ranks.index(self.rank) + 1) % len(ranks)]
        self._filter(rank=self.rank)

    def action_mute(self) -> None:
        """Hide a node in the log, or show it again."""
        row = self.nodes.chosen
        if row is not None:
            self._filter(muted=self.log_view.filter.muted ^ {row.name})
            self.nodes.refresh()

    def action_show_all(self) -> None:
        """Remove all filters."""
        self._close_find(keep=False)
        self.rank = 0
        self._filter(node="", rank=0, text="")

    def _filter(self, **changes: object) -> None:
        self.log_view.filter = replace(self.log_view.filter, **changes)  # type: ignore[arg-type]  # fields of Filter
        self.log_view.rebuild()
        self.draw()

    def action_clear(self) -> None:
        """Clear the log."""
        self.journal.clear()
        self.log_view.rebuild()
        self.draw()

    def action_help(self) -> None:
        """Show every key."""
        self.push_screen(TextDialog("Keys", describe_keys(self.palette), self.palette))

    def on_node_table_opened(self) -> None:
        """Open the log after a double click."""
        self.action_open_log()

    def action_open_log(self) -> None:
        """Open a node's log file in the pager."""
        row = self.nodes.chosen
        if row is None:
            return
        if not row.changed.log:
            self.show_notice(f"{row.name} has no log file")
            return
        if not self.services.has_content(row.changed.log):
            self.show_notice(f"{row.name} has printed nothing yet")
            return
        pager = self.services.find_pager()
        if pager is None:
            self.push_screen(read_page(row.name, row.changed.log, self.palette))
        else:
            self.report(self.services.run_here([*pager, row.changed.log]))

    def report(self, problem: str) -> None:
        """Show a problem ('' for none) and continue."""
        if problem:
            self.show_notice(problem)
        else:
            self.draw()
