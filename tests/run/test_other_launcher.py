"""`ur launch -- COMMAND`: another launcher, of which nothing is left."""

import signal
from typing import Any

import pytest

FORKS = '#!/bin/bash\nsetsid sleep 5000 &\nsleep 5001 &\necho "started $*"\n[[ $1 == wait ]] && sleep 5002\nexit 5\n'


@pytest.fixture
def forks(world: Any) -> str:
    path = world.folder / "forks"
    path.write_text(FORKS)
    path.chmod(0o755)
    return str(path)


def test_command_has_its_arguments_and_exit_code_and_leaves_nothing(world: Any, forks: str) -> None:
    run = world.ur("launch", "--", forks, "--now", "a:=b")
    assert run.wait() == 5, run.text
    assert "started --now a:=b" in run.text
    run.wait_nothing_left()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_end_of_the_guard_ends_all_that_the_command_has_started(world: Any, forks: str, number: int) -> None:
    run = world.ur("launch", "--", forks, "wait")
    run.until("started wait")
    run.until_running("sleep 5000", 1)
    run.look()
    run.process.send_signal(number)
    run.wait()
    run.wait_nothing_left()


def test_launch_file_before_the_command_is_refused(world: Any, forks: str) -> None:
    text = world.call("launch", world.write(""), "--", forks, code=2)
    assert "'--' has a launch file or a query before it" in text


def test_end_of_options_before_a_launch_file_is_none(world: Any) -> None:
    assert world.call("launch", "--nodes", "--", world.write("")) == ""
