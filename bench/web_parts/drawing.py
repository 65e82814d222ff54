"""The time that the page takes to draw a map of 4000 x 4000 cells: between frames, and of the processor."""

import math
from dataclasses import dataclass

import psutil
from tests.chromium import Chromium

FRAMES = 120
VIEWS = {  # pixels a metre, and what a frame changes
    "whole, panned": (4, "map.view.x += count % 40 < 20 ? 3 : -3"),
    "whole, zoomed": (6, "map.view.zoom(count % 40 < 20 ? 1.02 : 1 / 1.02, 700, 450)"),
    "near, panned": (60, "map.view.x += 0.05"),
}

# A map whose tiles are made on the page.
_MAP = """(() => {
  const map = page.map, tile = 256, side = 4000, generation = 4242;
  const size = { column: 0, row: 0, width: side, height: side };
  map.setGrid(1, { generation, resolution: 0.05, x: -100, y: -100, yaw: 0, ...size });
  let seed = 1;
  const count = Math.ceil(side / tile);
  for (let row = 0; row < count; row++) for (let column = 0; column < count; column++) {
    const cells = new Int8Array(tile * tile);
    for (let index = 0; index < cells.length; index += 1 + (seed % 40)) {
      seed = (seed * 16807) % 2147483647;
      cells[index] = seed % 101;
    }
    map.tiles.setTile(column, row, generation, cells);
  }
})()"""
_FRAME = "const map = page.map, frame = () => new Promise((done) => requestAnimationFrame(done));"
_SHOW = (
    f"(async () => {{ {_FRAME} map.show([0, 0, SCALE]); for (let count = 0; count < 20; count++) await frame(); }})()"
)
_MOVE = f"""(async () => {{
  {_FRAME}
  const times = [];
  let before = await frame();
  for (let count = 0; count < {FRAMES}; count++) {{
    CHANGE; map.request();
    const now = await frame();
    times.push(now - before); before = now;
  }}
  return times;
}})()"""


@dataclass(frozen=True)
class Drawing:
    """A view that moves: the 95th percentile of the times between frames, and processor time a frame, both in ms."""

    view: str
    frame: float
    processor: float


def percentile(values: list[float], share: float) -> float:
    """The value that this share of the values does not exceed."""
    return sorted(values)[max(0, math.ceil(share * len(values)) - 1)]


def measure_drawing(browser: Chromium) -> list[Drawing]:
    """Have a page that is connected draw a large map in each view."""
    browser.run(_MAP)
    found = []
    for view, (scale, change) in VIEWS.items():
        browser.run(_SHOW.replace("SCALE", str(scale)))
        before = _used_by_page(browser.pid)
        times = browser.run(_MOVE.replace("CHANGE", change))
        used = _used_by_page(browser.pid) - before
        found.append(Drawing(view, percentile(times, 0.95), 1000 * used / FRAMES))
    return found


def _used_by_page(pid: int) -> float:
    """Processor seconds of the processes that run and draw pages: without a graphics card all pixels are theirs."""
    pages = [each for each in psutil.Process(pid).children(recursive=True) if "--type=renderer" in each.cmdline()]
    return sum(sum(each.cpu_times()[:2]) for each in pages)
