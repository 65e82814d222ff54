"""Metres and pixels of the map: `static/view.js` and the bar of `static/map_scale.js`, run by Node.js."""

import json
import shutil
import subprocess
from typing import Any

import pytest

from ur.web.server.static_files import FOLDER

NODE = shutil.which("node")
pytestmark = pytest.mark.skipif(NODE is None, reason="Node.js is not installed")


def run(file: str, script: str) -> Any:
    """The value of a script that follows a module without what it imports."""
    assert NODE is not None
    lines = (FOLDER / file).read_text().splitlines()
    source = "\n".join(line for line in lines if not line.startswith("import "))
    command = [NODE, "--input-type=module", "-"]
    text = f"{source}\nconsole.log(JSON.stringify({script}));"
    done = subprocess.run(command, input=text, capture_output=True, text=True, timeout=120, check=True)
    return json.loads(done.stdout)


@pytest.mark.parametrize("turned", ["false", "true"])
def test_point_below_a_finger_stays_there_while_the_map_is_moved_and_zoomed(turned: str) -> None:
    first, moved, zoomed, back = run(
        "view.js",
        """(() => {
          const view = Object.assign(new View(), { x: 3, y: -2, scale: 50, width: 390, height: 844, turned: TURNED });
          const at = view.toPlane(100, 200), found = [view.toScreen(...at)];
          view.pan(30, -70); found.push(view.toScreen(...at));
          view.zoom(1.5, 130, 130); found.push(view.toScreen(...at));
          found.push(view.toYaw(view.toAngle(1)));
          return found;
        })()""".replace("TURNED", turned),
    )
    assert first == pytest.approx([100, 200])
    assert moved == pytest.approx([130, 130])
    assert zoomed == pytest.approx([130, 130])
    assert back == pytest.approx(1)


def test_arrow_points_on_the_screen_where_its_yaw_leads_on_the_map() -> None:
    for turned in ("false", "true"):
        start, end, angle = run(
            "view.js",
            f"""(() => {{
              const view = Object.assign(new View(), {{ width: 300, height: 500, turned: {turned} }});
              return [view.toScreen(0, 0), view.toScreen(Math.cos(0.4), Math.sin(0.4)), view.toAngle(0.4)];
            }})()""",
        )
        across, up = end[0] - start[0], start[1] - end[1]
        assert run("view.js", f"[Math.cos({angle}) * 40, Math.sin({angle}) * 40]") == pytest.approx([across, up])


def test_wide_map_is_turned_on_a_tall_page_only_where_it_is_much_larger_then() -> None:
    script = """[[20, 15, true], [20, 15, false], [15, 20, true], [16, 15, true]].map(([width, height, may]) => {
      const view = Object.assign(new View(), { width: 390, height: 844 });
      view.fit([0, 0, width, height], [8, 8, 56, 100], may);
      const corners = [view.toScreen(0, 0), view.toScreen(width, height)];
      const xs = corners.map((each) => each[0]), ys = corners.map((each) => each[1]);
      const across = Math.min(...xs) > 7.9 && Math.max(...xs) < 382.1;
      const inside = across && Math.min(...ys) > 55.9 && Math.max(...ys) < 744.1;
      return [view.turned, inside];
    })"""
    assert run("view.js", script) == [[True, True], [False, True], [False, True], [False, True]]


def test_bar_of_the_scale_has_a_round_length() -> None:
    assert run("map_scale.js", "[110, 9.99, 4.9, 1, 0.3, 0.02].map(longest)") == pytest.approx(
        [100, 5, 2, 1, 0.2, 0.02]
    )
