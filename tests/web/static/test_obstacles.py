"""The line above the stick about the obstacle stop."""

from typing import Any

import pytest
from tests.chromium import Chromium

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from tests.web.static.in_chromium import MARKS
from tests.web.static.played_robot import STATE, PlayedRobot, wait

from ur.web.wire.frames import Kind

pytestmark = MARKS


def show(robot: PlayedRobot, state: str, text: str = "") -> None:
    robot.show(Kind.STATE, STATE | {"mux": STATE["mux"] | {"obstacles": {"state": state, "text": text}}})


def line(page: Chromium) -> Any:
    shown = "document.getElementById('obstacles').getClientRects().length"
    return page.run(f"{shown} ? document.getElementById('obstacles').innerText.trim() : ''")


def test_line_names_what_stops_the_robot_and_its_button_turns_that_off_and_on(
    robot: PlayedRobot, browser: Chromium
) -> None:
    robot.asked.clear()
    browser.run("page.setMode('drive'); 0")
    show(robot, "clear")
    wait(lambda: line(browser).startswith("Stops before obstacles"))
    show(robot, "stopped", "stopped: obstacle close ahead")
    wait(lambda: line(browser).startswith("Stopped: obstacle close ahead"))
    browser.run("document.querySelector('#obstacles button').click(); 0")
    wait(lambda: robot.find("obstacles") == [{"t": "obstacles", "on": False}])
    show(robot, "off", "the obstacle stop is off")
    wait(lambda: line(browser).startswith("Does not stop before obstacles"))
    browser.run("page.setMode('look'); 0")
    wait(lambda: line(browser).startswith("Does not stop before obstacles"))
    robot.asked.clear()
    browser.run("document.querySelector('#obstacles button').click(); 0")
    wait(lambda: robot.find("obstacles") == [{"t": "obstacles", "on": True}])


def test_line_is_absent_on_a_robot_without_sensors_and_outside_of_drive(robot: PlayedRobot, browser: Chromium) -> None:
    browser.run("page.setMode('look'); 0")
    for state in ("none", "clear"):
        show(robot, state)
        wait(lambda: line(browser) == "")
    robot.show(Kind.STATE, STATE)  # of an older robot
    wait(lambda: line(browser) == "")
