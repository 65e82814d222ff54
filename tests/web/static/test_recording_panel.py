"""The panel of recordings in a real browser: what happened is saved, and the replay that runs is controlled."""

import json
from collections.abc import Iterator

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import PlayedRobot, wait

pytestmark = MARKS
REPLAY = {"position": 83.0, "length": 120.0, "speed": 1.0, "playing": True, "ended": False}


@pytest.fixture
def panel(browser: Chromium) -> Iterator[Chromium]:
    """The panel beside a replay; `posted` are the commands that it sends."""
    browser.run(f"""
      Object.assign(globalThis, {{ posted: [], replay: {json.dumps(REPLAY)}, fetched: globalThis.fetched ?? fetch }});
      globalThis.fetch = async (path, ...more) => {{
        if (path !== "/api/replay") return fetched(path, ...more);
        if (more[0]) {{
          const {{ name, value }} = JSON.parse(more[0].body);
          posted.push([name, value]);
          replay = {{ ...replay, playing: name === "pause" ? false : replay.playing }};
        }}
        return new Response(JSON.stringify(replay));
      }};
      page.panels.show(["recordings"]); 0""")
    wait(lambda: browser.run("page.recordings?.replay.box.checkVisibility() ?? false"))
    yield browser
    browser.run("page.panels.show([]); 0")


def press(browser: Chromium, text: str) -> None:
    browser.run(f"[...document.querySelectorAll('button')].find((e) => e.textContent === '{text}').click(); 0")


def test_what_happened_is_saved_and_the_place_of_the_file_shown(robot: PlayedRobot, panel: Chromium) -> None:
    press(panel, "Save what happened")
    wait(lambda: robot.find("save_recording"))
    answer = "page.recordings.happenedAnswer.textContent"
    assert panel.run(f"[page.recordings.happened.disabled, {answer}]") == [True, "Saving what happened ..."]
    panel.run("page.take({ t: 'done', what: 'save_recording', place: 'bob:/home/black_box.mcap' }); 0")
    assert panel.run(f"[page.recordings.happened.disabled, {answer}]") == [False, "Saved: bob:/home/black_box.mcap"]
    panel.run("page.take({ t: 'refused', what: 'save_recording', why: 'no service /black_box/write' }); 0")
    assert panel.run(answer) == "Not saved: no service /black_box/write"


def test_replay_that_runs_is_paused_moved_and_sped_up(panel: Chromium) -> None:
    view = "page.recordings.replay"
    assert panel.run(f"[{view}.note.textContent, {view}.slider.value]") == ["1:23 of 2:00", "83"]
    press(panel, "Pause")
    wait(lambda: panel.run(f"{view}.play.textContent") == "Play")
    press(panel, "Back 10 s")
    panel.run(f"{view}.slider.value = '95'; {view}.slider.dispatchEvent(new Event('change')); 0")
    panel.run(f"{view}.speed.value = '5'; {view}.speed.dispatchEvent(new Event('change')); 0")
    wait(lambda: panel.run("posted.length") == 4)
    assert panel.run("posted") == [["pause", 0], ["back", 10], ["jump", 95], ["speed", 5]]
    panel.run("replay = null; 0")
    wait(lambda: not panel.run(f"{view}.box.checkVisibility()"))
