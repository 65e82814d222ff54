from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from textual.widgets import Static

from ur.cli.maps.edit_screen import EditApp
from ur.maps.editing import EditSession
from ur.maps.picture_file import write_picture
from ur.maps.store import MapStore

VALUES = np.zeros((60, 100), np.int8)
VALUES[[0, -1]] = VALUES[:, [0, -1]] = 100


@pytest.fixture
def app(tmp_path: Path) -> EditApp:
    store = MapStore(tmp_path / "maps")
    with store.arriving("flat") as folder:
        write_picture(folder / "map", VALUES, 0.1, (0.0, 0.0, 0.0))
    return EditApp(EditSession(store, "flat", tmp_path / "flat.yaml"))


async def test_keys_draw_name_and_undo(app: EditApp) -> None:
    async with app.run_test(size=(80, 30)) as pilot:

        def message() -> str:
            return str(app.query_one("#message", Static).render())

        await pilot.press("space", *["shift+right"] * 2, "space", "w")
        assert message().startswith("wall: ")
        assert (app.session.image().values[30, 50:] == 100).sum() > 5
        await pilot.press("p", *"door", "enter")
        assert message().startswith("door is at ")
        assert "door" in app.session.places()
        assert "┼door" in "\n".join(app.canvas.render_line(y).text for y in range(20))
        await pilot.press("w")
        assert "0 points for wall" in message()
        await pilot.press("u", "u")
        assert message() == "wall: undone"
        assert np.array_equal(app.session.image().values, VALUES)
        await pilot.press("u")
        assert message().startswith("no change to undo")
        await pilot.press("q")
    assert app.return_code == 0


async def test_whole_map_is_shown_whatever_the_size_and_the_cursor_stays_in_view(app: EditApp) -> None:
    async with app.run_test(size=(80, 30)) as pilot:
        text = [app.canvas.render_line(y).text for y in range(app.canvas.size.height)]
        assert sum(line.count("┼") for line in text) == 1
        await pilot.resize_terminal(50, 16)
        await pilot.pause()
        await pilot.press("plus", "plus", *["shift+right"] * 6)
        view = app.canvas.view
        assert view is not None
        column, row = view.to_pixel(*app.canvas.cursor)
        assert 0 <= column < view.width
        assert 0 <= row < view.height
        await pilot.press("0")
        assert app.canvas.view is not None
        assert app.canvas.view.scale > view.scale
