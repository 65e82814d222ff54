"""`ur shell -X`: a window of a program on the robot, on the laptop's screen."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from tests.hosts.bench import UR, Bench, Machine, wait_until
from tests.hosts.test_doctor import pair

__all__ = ["pair"]
SCREEN = {"DISPLAY": ":7"}
# Without -noreset the server forgets its screen when the last window closes.
XVFB = "Xvfb :7 -screen 0 640x480x24 -nolisten tcp -noreset"


@contextmanager
def started(machine: Machine, line: str, user: str) -> Iterator[None]:
    """A program that runs inside meanwhile, and is told to end there."""
    process = subprocess.Popen(
        machine.command_line(f"echo $$; exec {line} >/dev/null 2>&1", user=user), stdout=subprocess.PIPE, text=True
    )
    assert process.stdout
    with process.stdout:
        number = int(process.stdout.readline())
    try:
        yield
    finally:
        machine.run(f"kill {number}")
        wait_until(lambda: process.poll() is not None, f"{line} ends", 60)


@pytest.fixture(scope="module")
def screen(pair: Bench) -> Iterator[Bench]:
    """The laptop has a screen, :7."""
    with started(pair["laptop"], XVFB, "pat"):
        pair["laptop"].wait_for("[ -S /tmp/.X11-unix/X7 ]", deadline=60)
        yield pair


def test_window_of_the_robot_is_seen_on_the_laptop(screen: Bench) -> None:
    laptop, robot = screen["laptop"], screen["robot"]
    done = laptop.run(f"{UR} shell -X --check bob", user="pat", environment=SCREEN).check()
    assert "opened" in done.out
    empty = take_picture(screen)
    with started(laptop, f"env DISPLAY=:7 {UR} shell -X bob xlogo -geometry 300x200+50+40", "pat"):
        # The window itself, by its name, and drawn: 60,000 pixels, of which the logo leaves more than half.
        laptop.wait_for("xwd -silent -name xlogo >w", user="pat", environment=SCREEN, deadline=60)
        wait_until(lambda: count_pixels(take_picture(screen), empty) > 20_000, "the window is drawn", 60)
        shown = count_pixels(take_picture(screen), empty)
        robot.wait_for("pgrep -u ros -x xlogo", deadline=60)
    sys.stdout.write(f"a window of the robot on the laptop's screen: {shown} pixels differ\n")
    # The program over there ended with `ur shell -X`, and its window with it.
    robot.wait_for("! pgrep -u ros -x xlogo", deadline=60)
    wait_until(lambda: count_pixels(take_picture(screen), empty) == 0, "the window is gone", 60)


def take_picture(pair: Bench) -> bytes:
    """What is on the laptop's screen, as xwd writes it."""
    line = pair["laptop"].command_line("xwd -silent -root", user="pat", environment=SCREEN)
    return subprocess.run(line, capture_output=True, check=True, timeout=60).stdout


def count_pixels(picture: bytes, other: bytes) -> int:
    """How many pixels differ, of four bytes each; the head of the file is as long as a whole number of them."""
    assert len(picture) == len(other)
    return sum(picture[at : at + 4] != other[at : at + 4] for at in range(len(picture) % 4, len(picture), 4))


def test_words_arrive_as_they_are_and_the_exit_code_comes_back(screen: Bench) -> None:
    line = f"{UR} shell -X bob sh -c 'echo \"$0\" $DISPLAY; exit 5' 'a  b'"
    done = screen["laptop"].run(line, user="pat", environment=SCREEN)
    assert done.code == 5
    assert done.out.startswith("a  b localhost:1")


def test_window_without_a_screen_is_explained(pair: Bench) -> None:
    done = pair["laptop"].run(f"{UR} shell -X --check bob", user="pat")
    assert done.code == 2
    assert "no display" in done.err
    done = pair["laptop"].run(f"{UR} shell -X --check bob", user="pat", environment={"DISPLAY": ":9"})
    assert done.code == 2
    assert "no window opened" in done.err
    assert "ur doctor" in done.err


def test_robot_that_is_away_is_explained(pair: Bench) -> None:
    for words in ("shell -X --check nobody", "shell -X nobody xlogo"):
        done = pair["laptop"].run(f"{UR} {words}", user="pat", environment=SCREEN)
        assert done.code == 2
        assert "no computer answers to this name" in done.err
