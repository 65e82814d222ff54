"""The running app, for its tests."""

import contextlib
from collections.abc import AsyncIterator
from typing import Any

from tests.ur_nodes.teleop.recordings import no_recordings
from textual.pilot import Pilot
from textual.widgets import Static

from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.teleop.navigate.app import NavigateApp
from ur_nodes.teleop.navigate.command_line import CommandLine
from ur_nodes.teleop.navigate.panel import Panel


class AppScreen:
    """The running app as a user has it before them."""

    def __init__(self, app: NavigateApp, pilot: Pilot[None]) -> None:
        self.app = app
        self.pilot = pilot

    async def type(self, line: str) -> None:
        self.app.query_one(CommandLine).value = line
        await self.pilot.press("enter")
        await self.refresh()

    async def refresh(self) -> None:
        self.app._look()
        await self.pilot.pause()

    @property
    def panel(self) -> Panel:
        return self.app.query_one(Panel)

    def panel_text(self) -> str:
        return "\n".join(
            "".join(segment.text for segment in line)
            for line in self.app.console.render_lines(self.panel.query_one(Static).content)  # type: ignore[arg-type]
        )

    def text(self, id: str) -> str:
        return str(self.app.query_one(f"#{id}", Static).render())


@contextlib.asynccontextmanager
async def open_app(navigator: Any, store: WaypointStore, size: tuple[int, int] = (100, 36)) -> AsyncIterator[AppScreen]:
    """The app on a terminal of so many columns and rows."""
    app = NavigateApp(navigator, lambda _: store, recording=no_recordings(), title="maze")
    async with app.run_test(size=size) as pilot:
        await pilot.pause()
        yield AppScreen(app, pilot)
