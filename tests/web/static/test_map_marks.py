"""What lies over the map: labels of places, frontiers, the robot beside the stick, and goals that others send."""

from collections.abc import Iterator

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, PlayedRobot, wait
from tests.web.static.test_layout import LEASE, list_covered, set_size

from ur.web.wire.frames import Kind, Layer, json_frame

pytestmark = MARKS
QUIET = STATE | {"bumpers": []}
GOAL = {"number": 1, "place": [1.0, 0.0, 0.0], "state": "driving", "text": "", "left": 2.3}
EXPLORING = {"exploring": {"state": "exploring", "line": "72 m² known"}}
# The boxes of all labels of places, and of their marks, as they are drawn.
LABELS = """(() => {
  const { map } = page, drawn = [], { strokeText } = map.context;
  map.context.strokeText = (text, x, y) => drawn.push([x, y - 11, x + map.context.measureText(text).width, y + 3]);
  map.drawPlaces();
  map.context.strokeText = strokeText;
  const marks = Object.values(map.places).map(([x, y]) => map.view.toScreen(x, y));
  return [drawn, marks.map(([x, y]) => [x - 5, y - 5, x + 5, y + 5])];
})()"""


@pytest.fixture
def page(robot: PlayedRobot, browser: Chromium) -> Iterator[Chromium]:
    """The page, on which nothing happens."""
    yield browser
    robot.show(Kind.STATE, QUIET)
    browser.run("page.setMode('look'); page.panels.show([]); 0")


def overlap(one: list[float], other: list[float]) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def test_labels_of_places_near_one_another_lie_on_no_label_and_no_mark(robot: PlayedRobot, page: Chromium) -> None:
    places = {"my place": [0, 0, 0], "test1": [0.2, 0.05, 0], "door": [-0.9, 0, 0], "a": [0.1, -0.2, 0]}
    robot.show(Kind.PLACES, {"named": True, "places": places, "problem": ""})
    wait(lambda: page.run("Object.keys(page.map.places).length") == 4)
    page.run("page.map.show([0, 0, 60]); 0")
    labels, marks = page.run(LABELS)
    assert len(labels) == len(marks) == 4
    for index, label in enumerate(labels):
        assert not [each for each in [*labels[:index], *marks] if overlap(label, each)]
    robot.show(Kind.PLACES, {"named": True, "places": {"alone": [0, 0, 0]}, "problem": ""})
    wait(lambda: page.run("Object.keys(page.map.places)") == ["alone"])
    ((label,), (mark,)) = page.run(LABELS)
    assert label[0] > mark[2], "right of its mark, where there is room"
    page.run("page.map.view.pan(page.map.view.width / 2 - 30, 0); 0")
    ((label,), (mark,)) = page.run(LABELS)
    assert label[2] < mark[0], "left of it at the right edge"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_frontier_that_was_given_up_has_a_colour_of_its_own_which_layers_names(page: Chromium, scheme: str) -> None:
    page.prefer(scheme)
    colours: dict[str, str] = page.run("(page.map.readColours(), page.map.colours)")
    own = colours.pop("given-up")
    assert own
    assert own not in colours.values()
    frame = list(json_frame(Kind.OVERLAY, {"frontiers": [[1, 0, 0], [0, 1, 0]]}, Layer.FRONTIERS))
    page.run(
        f"import('/wire.js').then(({{ readFrame }}) => page.frames.take(readFrame(new Uint8Array({frame}).buffer)))"
    )
    drawn = page.run("""(() => {
      const { map } = page, { fillRect } = map.context, drawn = [];
      map.context.fillRect = () => drawn.push(map.context.fillStyle);
      page.overlays.paint(map.context, map.view, map.colours);
      map.context.fillRect = fillRect;
      return drawn;
    })()""")
    assert drawn == [own, colours["frontiers"]]
    label = "document.querySelector('label:has(#layer-frontiers)').textContent"
    assert page.run(label) == "Frontiers (grey: given up)"
    red, green, blue = (int(own[at : at + 2], 16) for at in (1, 3, 5))
    assert max(red, green, blue) - min(red, green, blue) < 32, "it is grey"
    page.prefer("light")


@pytest.mark.parametrize("size", [(390, 844), (844, 390), (1280, 800)])
def test_robot_is_moved_from_below_the_stick_and_the_hint_leaves_when_it_drives(
    page: Chromium, size: tuple[int, int]
) -> None:
    set_size(page, size)
    page.run("page.setMode('drive'); 0")
    assert page.run("document.getElementById('hint').checkVisibility()")
    for share in (0.5, 0.95):  # of the stick's width; above its right end are the buttons of the map
        page.run(f"""(() => {{
          const {{ left, top, width, height }} = document.getElementById("stick").getBoundingClientRect();
          const {{ map }} = page, [rx, ry] = map.view.toScreen(map.pose.x, map.pose.y);
          map.whole = false;
          map.view.pan(left + {share} * width - rx, top + height / 2 - ry);
        }})()""")
        robot_at = "page.map.view.toScreen(page.map.pose.x, page.map.pose.y)"
        wait(lambda: page.run(f"document.elementFromPoint(...{robot_at})?.id") == "map")  # noqa: B023
    page.run("page.push(0.5, 0); page.stick.onLetGo(); 0")
    assert not page.run("document.getElementById('hint').checkVisibility()")
    page.run("page.setMode('look'); page.map.fit(); 0")
    set_size(page, (1200, 800))


def test_goals_of_an_exploration_are_on_the_map_and_neither_said_nor_shown_as_ones_of_this_page(
    robot: PlayedRobot, page: Chromium
) -> None:
    page.run("document.getElementById('heard').replaceChildren(); 0")
    shown = "[document.getElementById('heard').textContent, document.getElementById('banners').innerText]"
    states = [
        GOAL,
        GOAL | {"number": 2},
        GOAL | {"number": 2, "state": "reached"},
        GOAL | {"number": 3, "state": "stopped"},
    ]
    for state in states:
        robot.show(Kind.STATE, QUIET | EXPLORING | {"goal": state})
        wait(lambda state=state: page.run("page.state.goal") == state)
        assert not page.run("document.getElementById('goal').checkVisibility()")
        assert page.run("page.map.goal !== null") == (state["state"] == "driving")
        assert not [text for text in page.run(shown) if "Goal" in text or "Driving" in text]
    own = LEASE | {"client": page.run("page.drive.client")}
    robot.show(Kind.STATE, QUIET | EXPLORING | {"goal": GOAL | {"number": 4}, "lease": own})
    wait(lambda: page.run("document.getElementById('goal-text').checkVisibility()"))
    assert "Driving" in page.run("document.getElementById('heard').textContent")
    robot.show(Kind.STATE, QUIET | EXPLORING | {"goal": GOAL | {"number": 4, "state": "reached"}, "lease": own})
    wait(lambda: "Goal reached" in page.run("document.getElementById('banners').innerText"))


@pytest.mark.parametrize("ratio", [1, 1.25, 1.5, 1.75, 2])
def test_map_is_drawn_to_the_last_pixel_beside_a_panel_on_every_screen(page: Chromium, ratio: float) -> None:
    page.run("page.panels.show(['programs']); 0")
    for width in range(1000, 1005):
        page.ask("Emulation.setDeviceMetricsOverride", width=width, height=701, deviceScaleFactor=ratio, mobile=False)
        wait(lambda: page.run("[innerWidth, devicePixelRatio]") == [width, ratio])  # noqa: B023
        page.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        corners = page.run("""(() => {
          const { width, height } = page.map.canvas, options = { willReadFrequently: true };
          const copy = new OffscreenCanvas(width, height).getContext("2d", options);
          copy.drawImage(page.map.canvas, 0, 0);
          const corners = [[0, 0], [width - 1, 0], [width - 1, height - 1]];
          return corners.map(([x, y]) => [...copy.getImageData(x, y, 1, 1).data]);
        })()""")
        assert corners[1:] == [corners[0]] * 2
    set_size(page, (1200, 800))


def test_who_drives_is_whole_above_an_open_panel_of_a_phone(robot: PlayedRobot, page: Chromium) -> None:
    lease = LEASE | {
        "name": "Chrome on the laptop of the lab, page 2",
        "asking": [{"client": page.run("page.drive.client"), "name": "x"}],
    }
    robot.show(Kind.STATE, QUIET | {"lease": lease, "mux": STATE["mux"] | {"stopped": True}})
    for size in ((390, 844), (360, 640)):
        set_size(page, size)
        page.run("page.panels.show(['places']); 0")
        wait(lambda: page.run("document.querySelectorAll('.banner').length") == 2)
        assert list_covered(page, ".banner, .banner button") == []
        box = "(({ clientHeight, scrollHeight }) => [clientHeight, scrollHeight])(document.getElementById('banners'))"
        height, needed = page.run(box)
        assert height == needed
    set_size(page, (1200, 800))


def test_title_of_a_panel_is_a_button_that_enlarges_it_by_keys(page: Chromium) -> None:
    set_size(page, (1366, 650))
    page.run("page.panels.show(['layers', 'programs']); 0")
    titles = "['layers', 'programs'].map((name) => document.querySelector(`#${name}-panel h2 button`))"
    assert page.run(f"{titles}.map((e) => e.ariaExpanded)") == ["false", "true"]
    before = page.run("document.getElementById('layers-panel').clientHeight")
    page.run(f"{titles}[0].focus(); 0")
    page.press("Enter")
    assert page.run(f"{titles}.map((e) => e.ariaExpanded)") == ["true", "false"]
    assert page.run("document.getElementById('layers-panel').clientHeight") > before
    assert page.run("document.activeElement.textContent") == "Layers"
    set_size(page, (1200, 800))


def test_fields_of_a_program_have_words_for_names_and_no_text_speaks_of_a_terminal(page: Chromium) -> None:
    found = page.run("""(async () => {
      const { fillForm } = await import("/argument_form.js"), form = document.createElement("form");
      const names = ["bring_up", "simulate", "robot_base", "map"];
      fillForm(form, names.map((name) => ({ name, doc: "", default: null, values: [] })), "x");
      const { TEXTS } = await import("/texts.js"), { DATA_TEXTS } = await import("/data/texts.js");
      const list = (all) => Object.values(all).flatMap((each) =>
        typeof each === "object" ? list(each) : [String(each)]);
      const spoken = [...list(TEXTS), ...list(DATA_TEXTS)].filter((text) => /terminal/i.test(text));
      return [[...form.querySelectorAll("label")].map((each) => each.textContent), spoken];
    })()""")
    assert found == [["Start the base", "Simulate the robot", "Robot base", "Map"], []]
