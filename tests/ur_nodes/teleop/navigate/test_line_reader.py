import os
import threading
from collections.abc import Iterator

import pytest

from ur_nodes.teleop.navigate.commands import AskMux, CancelGoal, Command, Quit
from ur_nodes.teleop.navigate.line_program import LineReader


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    reading, writing = os.pipe()
    yield reading, writing
    os.close(reading)


def test_lines_come_in_order_and_the_last_may_lack_its_end(pipe: tuple[int, int]) -> None:
    os.write(pipe[1], "g 1 2\nm küche\nl".encode())
    os.close(pipe[1])
    assert list(LineReader(pipe[0], threading.Event())) == ["g 1 2", "m küche", "l"]


@pytest.mark.parametrize(("line", "command"), [("x", CancelGoal()), ("e", AskMux("stop")), ("r", AskMux("release"))])
def test_urgent_command_is_taken_before_lines_that_wait(pipe: tuple[int, int], line: str, command: Command) -> None:
    os.write(pipe[1], f"g 1 2\nnonsense\n{line}\nl\n".encode())
    os.close(pipe[1])
    reader = LineReader(pipe[0], threading.Event())
    assert reader.pop_urgent() == command
    assert reader.pop_urgent() is None
    assert list(reader) == ["g 1 2", "nonsense", "l"]


def test_nothing_is_read_after_quit(pipe: tuple[int, int]) -> None:
    os.write(pipe[1], b"g 1 2\nq\nl\n")
    os.close(pipe[1])
    reader = LineReader(pipe[0], threading.Event())
    assert reader.pop_urgent() == Quit()
    assert list(reader) == []


def test_no_line_is_returned_once_the_program_is_to_end(pipe: tuple[int, int]) -> None:
    os.write(pipe[1], b"g 1 2\n")
    ended = threading.Event()
    ended.set()
    assert list(LineReader(pipe[0], ended)) == []
    os.close(pipe[1])
