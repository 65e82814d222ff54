"""A page in a real browser, and the server behind it, for all tests of a file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest
from tests.chromium import Chromium
from tests.web.static.in_chromium import PROGRAM

if TYPE_CHECKING:
    from tests.web.static.played_robot import PlayedRobot


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[PlayedRobot]:
    """A server whose robot's end is played by the test."""
    from tests.web.static.played_robot import PlayedRobot  # it needs aiohttp, which other tests of this folder do not

    with PlayedRobot(tmp_path_factory.mktemp("robot")) as robot:
        yield robot


@pytest.fixture(scope="module")
def browser(robot: PlayedRobot, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Chromium]:
    """The page of that server as on a desk, logged in and connected. At the end it must have complained of nothing."""
    from tests.web.static.played_robot import wait

    assert PROGRAM is not None
    with Chromium(PROGRAM, tmp_path_factory.mktemp("chromium")) as browser:
        browser.resize(1200, 800)
        browser.open(robot.link)
        wait(lambda: browser.holds("globalThis.page?.state && page.map.pose && page.drive.newest"))
        yield browser
        assert browser.faults == []
