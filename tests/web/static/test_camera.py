"""The camera of the page in a real browser: one of several is chosen, and its picture takes the whole screen."""

from collections.abc import Iterator

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, PlayedRobot, wait
from tests.web.static.test_layout import BUSY, PHONES, WIDE, list_covered, set_size

from ur.web.wire.frames import Kind

pytestmark = MARKS
FRONT, REAR = STATE["cameras"]["topics"]
SEEN = "[page.camera.isSpread, document.fullscreenElement !== null, page.panels.shown]"


@pytest.fixture
def page(robot: PlayedRobot, browser: Chromium) -> Iterator[Chromium]:
    """The page with the panel of the camera, and another one that was opened later."""
    robot.show(Kind.STATE, BUSY)
    set_size(browser, (1200, 800))
    browser.run("page.panels.show(['camera', 'layers']); 0")
    wait(lambda: browser.run("page.camera.socket?.readyState") == 1 and browser.run("page.camera.topic") == FRONT)
    yield browser
    browser.run("page.panels.show([]); page.setMode('look'); 0")


def spread(page: Chromium) -> None:
    """Click on the button of the full screen: browsers allow it to users only."""
    page.run("document.getElementById('camera-full').scrollIntoView({ block: 'nearest' }); 0")
    box = "document.getElementById('camera-full').getBoundingClientRect()"
    x, y = page.run(f"[{box}.left + {box}.width / 2, {box}.top + {box}.height / 2]")
    for kind in ("mousePressed", "mouseReleased"):
        page.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)
    wait(lambda: page.run(SEEN)[:2] == [True, True])


def choose(page: Chromium, topic: str) -> None:
    page.run(f"page.camera.choice.value = '{topic}'; page.camera.choice.dispatchEvent(new Event('change')); 0")


def test_camera_is_chosen_where_there_are_several(robot: PlayedRobot, page: Chromium) -> None:
    assert page.run("[...page.camera.choice.options].map((each) => each.value)") == [FRONT, REAR]
    page.run("page.camera.count = 1; 0")
    choose(page, REAR)
    wait(lambda: robot.camera == REAR)
    robot.show(Kind.STATE, BUSY | {"cameras": {"topic": REAR, "topics": [FRONT, REAR]}})
    wait(lambda: page.run("page.camera.topic") == REAR)
    assert page.run("[page.camera.choice.value, page.camera.count]") == [REAR, 0], "no picture of the one before"
    choose(page, FRONT)
    page.run("page.camera.chosenAt = -Infinity; page.camera.check(); 0")
    assert page.run("page.camera.choice.value") == REAR, "the one that is shown, where the other one does not come"
    robot.show(Kind.STATE, BUSY | {"cameras": {"topic": REAR, "topics": [REAR]}})
    wait(lambda: not page.run("page.camera.choice.checkVisibility()"))


@pytest.mark.parametrize("size", [*PHONES, *WIDE])
def test_full_screen_leaves_stop_stick_and_banners_in_reach(page: Chromium, size: tuple[int, int]) -> None:
    set_size(page, size)
    page.run("page.panels.show(['camera']); page.setMode('goal'); 0")
    spread(page)
    assert page.run("page.mode") == "look", "the map is covered"
    for mode in ("look", "drive"):
        page.run(f"page.setMode('{mode}'); 0")
        reach = "#stop, #stick, #modes button, #goal button, .banner:first-child button, #camera-panel .row > *"
        assert list_covered(page, reach) == []
    seen = page.run("(({ width, height }) => [width, height])(page.camera.box.getBoundingClientRect())")
    assert seen == [page.run("innerWidth"), page.run("innerHeight")]
    page.run("page.panels.close('camera'); 0")
    wait(lambda: page.run(SEEN) == [False, False, []])


@pytest.mark.parametrize("how", ["Escape", "back", "browser"])
def test_full_screen_ends_by_key_or_back_button_and_the_panels_stay(page: Chromium, how: str) -> None:
    spread(page)
    if how == "Escape":
        page.press("Escape")
    elif how == "browser":  # as its own key, or the back button of Android
        page.run("document.exitFullscreen()")
    elif page.run("page.panels.back === null"):
        pytest.skip("this Chromium has no CloseWatcher")
    else:
        page.run("page.panels.back.requestClose(); 0")
    wait(lambda: page.run(SEEN) == [False, False, ["camera", "layers"]])
    assert page.run("document.getElementById('camera-full').textContent") == "Full screen"
    if how == "Escape":
        page.press("Escape")
    elif how == "back":
        page.run("page.panels.back.requestClose(); 0")
    left = {
        "Escape": ["layers"],
        "back": ["camera"],
        "browser": ["camera", "layers"],
    }  # Escape: the panel with the focus
    wait(lambda: page.run("page.panels.shown") == left[how])


def test_keys_reach_what_is_seen_in_full_screen_and_nothing_else(page: Chromium) -> None:
    spread(page)
    seen = "['camera-topic', 'camera-full', 'stop', 'mode-look', 'mode-drive']"
    found = set()
    for _ in range(12):
        page.press("Tab")
        focused = "document.activeElement"
        assert page.run(f"{focused}.checkVisibility({{ visibilityProperty: true }})"), page.run(f"{focused}.id")
        found.add(page.run(f"{focused}.id"))
    assert page.run(f"{seen}.filter((each) => !{sorted(found)}.includes(each))") == []
