"""The map on the canvas of a real browser: a far view that is copied shows the same as one that is drawn anew."""

import pytest
from tests.chromium import Chromium

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


@pytest.mark.parametrize("turned", ["false", "true"])
@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_far_map_that_is_panned_looks_like_one_that_is_drawn_anew(browser: Chromium, yaw: float, turned: str) -> None:
    browser.run(MAP.replace("YAW", str(yaw)))
    browser.run(f"page.map.show([0, 0, 8], {turned}); draw(); draw(); 0")
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
        # A picture that is turned by more than 90 degrees is rounded twice.
        assert browser.run("differ(draw(), anew())") <= (8 if yaw and turned == "true" else 0), (across, up)
        browser.run("draw(); 0")


def test_tile_that_changes_and_a_nearer_view_are_shown_at_once(browser: Chromium) -> None:
    browser.run(MAP.replace("YAW", "0"))
    browser.run("page.map.show([0, 0, 8]); draw(); draw(); 0")
    assert browser.run("(() => { const before = draw(); makeTile(1, 1); return differ(before, draw()); })()") > 0
    browser.run("draw(); page.map.view.zoom(2, 400, 300); 0")
    assert browser.run("differ(draw(), anew())") == 0
    browser.run("page.map.show([0, 0, 60]); draw(); 0")
    assert browser.run("page.map.tiles.cache.context") is None  # its memory is free


@pytest.mark.parametrize("turned", ["false", "true"])
@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_wall_is_drawn_where_the_view_has_its_place(browser: Chromium, yaw: float, turned: str) -> None:
    browser.run(MAP.replace("YAW", str(yaw)))
    colours = browser.run(f"""(() => {{
      const {{ map }} = page, {{ cells }} = map.tiles.tiles.get("1 1"), {{ grid, palette }} = map.tiles, found = [];
      for (const cell of [257, 1000, 40000, 65278]) {{
        cells.fill(0); for (const step of [-257, -256, -255, -1, 0, 1, 255, 256, 257]) cells[cell + step] = 100;
        map.tiles.setTile(1, 1, grid.generation, cells);
        const [x, y] = [256 + (cell % 256) + 0.5, 256 + Math.floor(cell / 256) + 0.5].map((each) => each * 0.05);
        const [c, s] = [Math.cos(grid.yaw), Math.sin(grid.yaw)];
        map.show([grid.x + c * x - s * y + 1, grid.y + s * x + c * y - 0.7, 100], {turned});
        const at = map.view.toScreen(grid.x + c * x - s * y, grid.y + s * x + c * y).map(Math.round);
        const pixels = draw(), start = 4 * (at[1] * map.canvas.width + at[0]);
        found.push(((255 << 24) | (pixels[start + 2] << 16) | (pixels[start + 1] << 8) | pixels[start]) >>> 0);
      }}
      return [found, palette[100]];
    }})()""")
    assert colours[0] == [colours[1]] * 4
