"""The drive on a pseudo-terminal: keys are passed on, the screen follows, and every way out restores it."""

from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from tests.ur_nodes.teleop.keyboard.rig import AHEAD, STILL, Driving
from tests.ur_nodes.teleop.screen import TypedTerminal, running

from ur_nodes.teleop.keyboard.teleop_twist_keyboard_node import drive_by_terminal


@dataclass
class Shown:
    """A drive whose bus runs in real time beside its screen."""

    rig: Driving
    screen: TypedTerminal


@pytest.fixture
def shown() -> Iterator[Shown]:
    rig = Driving()
    screen = TypedTerminal(lambda terminal, ended: drive_by_terminal(terminal, rig.driver, ended))
    with running(rig.bus), screen:
        yield Shown(rig, screen)


def test_key_drives_and_the_screen_shows_it(shown: Shown) -> None:
    shown.screen.wait_for("keyboard drive")
    shown.screen.type("i")
    shown.screen.wait_for("▲ driving")
    shown.screen.wait(lambda: STILL in shown.rig.sent)
    assert shown.rig.sent[0] == AHEAD


def test_terminal_that_reports_releases_is_asked_for_a_sign_of_life_while_a_key_is_held(shown: Shown) -> None:
    shown.screen.wait_for("\x1b[>15u\x1b[?u")
    shown.screen.type("\x1b[?15u")
    shown.screen.wait_for("the robot stops when you let go")
    asked = shown.screen.text.count("\x1b[?u")
    shown.screen.type("\x1b[1;1:1A")
    shown.screen.wait(lambda: shown.screen.text.count("\x1b[?u") > asked)


def test_ctrl_c_ends_the_screen(shown: Shown) -> None:
    shown.screen.type("\x03")
    shown.screen.wait_end()
    shown.screen.wait(lambda: shown.screen.text.rstrip().endswith("\x1b[?1049l"))
