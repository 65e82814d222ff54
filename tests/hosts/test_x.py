"""`ur x`: a window of a program on the robot, on the laptop's screen."""

from __future__ import annotations

import pytest
from tests.hosts.bench import UR, Bench
from tests.hosts.test_doctor import pair
from tests.hosts.test_robot_setup import running

pytestmark = pytest.mark.long
__all__ = ["pair"]
SCREEN = {"DISPLAY": ":7"}


def test_window_of_the_robot_opens_on_the_laptop(pair: Bench) -> None:
    laptop = pair["laptop"]
    with running(laptop, "Xvfb :7 -screen 0 640x480x24 -nolisten tcp", "pat"):
        laptop.wait_for("[ -S /tmp/.X11-unix/X7 ]")
        done = laptop.run(f"{UR} x --check bob", user="pat", environment=SCREEN).check()
        assert "opened" in done.out
        with running(laptop, f"env DISPLAY=:7 {UR} x bob xlogo", "pat"):
            pair["robot"].wait_for("pgrep -u ros -x xlogo")


def test_window_without_a_screen_is_explained(pair: Bench) -> None:
    done = pair["laptop"].run(f"{UR} x --check bob", user="pat")
    assert done.code == 2
    assert "no display" in done.err
    done = pair["laptop"].run(f"{UR} x --check bob", user="pat", environment={"DISPLAY": ":9"})
    assert done.code == 2
    assert "no window opened" in done.err
