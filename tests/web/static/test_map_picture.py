"""The map on the canvas of a real browser: a far view that is copied shows the same as one that is drawn anew."""

from __future__ import annotations

import pytest
from tests.docs.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import wait

pytestmark = MARKS
# A map of 1000 x 1000 cells of 0.05 m with walls at random, and functions to compare what is drawn: scaling
# rounds differently at the edge of a canvas, by a few of 255.
MAP = """(() => {
  const { map } = page, tile = 256, generation = 4242;
  let seed = 1;
  const random = () => (seed = (seed * 16807) % 2147483647);
  const makeTile = (column, row) => {
    const cells = new Int8Array(tile * tile);
    for (let index = 0; index < cells.length; index += 1 + (random() % 90)) cells[index] = 100;
    map.tiles.setTile(column, row, generation, cells);
  };
  const { width, height } = map.canvas;
  const copy = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  const pixels = () => (copy.drawImage(map.canvas, 0, 0), copy.getImageData(0, 0, width, height).data);
  const draw = () => (map.draw(), pixels());
  const anew = () => ((map.tiles.version += 1), draw());
  const differ = (one, other) => one.reduce((sum, each, index) => sum + (Math.abs(each - other[index]) > 24), 0);
  const size = { column: 0, row: 0, width: 1000, height: 1000 };
  map.setGrid(1, { generation, resolution: 0.05, x: -25, y: -25, yaw: YAW, ...size });
  for (let row = 0; row < 4; row++) for (let column = 0; column < 4; column++) makeTile(column, row);
  Object.assign(globalThis, { makeTile, draw, anew, differ });
})()"""


@pytest.fixture(scope="module")
def browser(browser: Chromium) -> Chromium:
    """The page that draws only when it is told to."""
    browser.resize(800, 600)
    wait(lambda: browser.holds("page.map.canvas.width === 800"))
    browser.run("page.map.setPose = () => {}; page.map.pose = null; page.map.request = () => {}; 0")
    return browser


@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_far_map_that_is_panned_looks_like_one_that_is_drawn_anew(browser: Chromium, yaw: float) -> None:
    browser.run(MAP.replace("YAW", str(yaw)))
    browser.run("page.map.show([0, 0, 8]); draw(); draw(); 0")
    assert browser.run("page.map.tiles.cache.made")
    assert (
        browser.run("(() => { const before = draw(); page.map.view.pan(1, 0); return differ(before, draw()); })()")
        > 1000
    )
    for across, up in (
        (3, 0),
        (40, -25),
        (-200, 120),
        (300, 300),
        (-900, 0),
    ):  # pixels; the last ones leave the picture
        browser.run(f"page.map.view.pan({across}, {up}); 0")
        assert browser.run("differ(draw(), anew())") == 0, (across, up)
        browser.run("draw(); 0")


def test_tile_that_changes_and_a_nearer_view_are_shown_at_once(browser: Chromium) -> None:
    browser.run(MAP.replace("YAW", "0"))
    browser.run("page.map.show([0, 0, 8]); draw(); draw(); 0")
    assert browser.run("(() => { const before = draw(); makeTile(1, 1); return differ(before, draw()); })()") > 0
    browser.run("draw(); page.map.view.zoom(2, 400, 300); 0")
    assert browser.run("differ(draw(), anew())") == 0
    browser.run("page.map.show([0, 0, 60]); draw(); 0")
    assert browser.run("page.map.tiles.cache.context") is None  # its memory is free
