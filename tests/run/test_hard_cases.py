"""Nodes, disks and masters that misbehave: the run copes and says so."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest
from tests.run.leftovers import find_processes, wait_nothing_left

from ur.run.output.log_rotation import MARK

pytestmark = pytest.mark.ros


@pytest.mark.usefixtures("master")
def test_node_that_refuses_its_input_again_and_again_is_given_up_and_named(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes" type="refuse" name="refuse" respawn="true"/>')
    assert run.wait() == 1
    assert (
        "error: /refuse died: exit code 2, 3 times in a row soon after its start: it is not started again" in run.text
    )
    assert "  | speed: expected a number" in run.text
    assert "try: exit code 2 is about what it was given" in run.text


@pytest.mark.usefixtures("master")
@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("#!/usr/bin/env python3\r\nprint('x')\r\n", "try: Windows line endings: "),
        ("#!/usr/bin/python3\r\nprint('x')\r\n", "try: Windows line endings: "),
        ("#!/usr/bin/env nopython\n", "try: interpreter 'nopython' is not installed: install nopython"),
        ("print('x')\n", "try: the file does not begin with '#!'"),
        ("#!/usr/bin/python3\nimport sys\nprint 'x'\n", "is Python 2, which Python 3 does not read: 2to3 -w "),
    ],
)
def test_script_that_does_not_start_is_explained_by_its_text(world: Any, text: str, advice: str) -> None:
    script = world.folder / "little_nodes/nodes/broken"
    script.write_text(text)
    script.chmod(0o755)
    run = world.launch('<node pkg="little_nodes" type="broken" name="broken"/>')
    run.wait()
    assert advice in run.text
    assert "a command that it calls" not in run.text


@pytest.mark.usefixtures("master")
def test_nodes_that_wait_for_a_simulated_time_are_reported_in_a_line(world: Any) -> None:
    sleeper = '<node pkg="little_nodes" type="sleeper" name="sleeper"/>'
    run = world.launch(f'<param name="/use_sim_time" value="true"/>{sleeper}')
    run.until("no node has published /clock for 5 s, and /use_sim_time is true")
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0


@pytest.mark.usefixtures("master")
def test_flood_of_lines_neither_stops_the_run_nor_grows_it(world: Any) -> None:
    run = world.launch(
        '<node pkg="little_nodes" type="flood" name="flood" output="screen"/>'
        '<node pkg="little_nodes" type="ticker" name="ticker" output="screen"/>'
    )
    run.until("lines are not shown here; the log file has them")
    run.text = ""  # it is long
    run.until("[/flood] ", "[/ticker] tick")
    assert psutil.Process(run.process.pid).memory_info().rss < 100e6
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0
    wait_nothing_left(world.folder, without=frozenset({world.master_pid}))


@pytest.mark.usefixtures("master")
def test_nobody_reading_a_flood_does_not_hold_the_run_up(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes" type="flood" name="flood" output="screen"/>')
    run.until("[/flood] 1000 ")
    log = next(Path(world.folder, "ros/log").glob("*/flood-*-stdout.log"))
    size = log.stat().st_size
    while log.stat().st_size < size + 1_000_000:  # it goes on while we read nothing
        assert run.process.poll() is None
    run.process.send_signal(signal.SIGINT)
    assert run.process.wait(60) == 0


@pytest.mark.usefixtures("master")
def test_log_file_of_a_flood_is_cut_and_keeps_the_newest_lines_in_order(world: Any) -> None:
    world.environment["UR_LOG_MB"] = "0.5"
    run = world.launch('<node pkg="little_nodes" type="flood" name="flood"/>')
    run.until("[/flood] started")
    log = next(Path(world.folder, "ros/log").glob("*/flood-*-stdout.log"))
    with log.open("rb") as file:
        while os.pread(file.fileno(), len(MARK), 0) != MARK:
            assert run.process.poll() is None
            run.read()
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0
    lines = [line for line in log.read_bytes().split(b"\n")[:-1] if not line.startswith(MARK)]
    numbers = [int(line.split()[0]) for line in lines]
    assert numbers[0] > 1
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


@pytest.mark.usefixtures("master")
def test_binary_output_leaves_the_terminal_alone_and_the_log_complete(world: Any) -> None:
    run = world.launch('<node pkg="little_nodes" type="binary" name="binary" output="screen"/>')
    assert run.wait() == 0
    shown = [line for line in run.text.splitlines() if line.startswith("[/binary]")]
    assert shown
    assert not any(character in line for line in shown for character in "\x07\x0e\x9b\x00")
    assert "\x1b[2J" not in run.text
    log = next(Path(world.folder, "ros/log").glob("*/binary-*-stdout.log"))
    assert log.read_bytes() == bytes(range(256)) * 40 + b"\x1b[2J\x1b]0;title\x07\n"


def start_on_small_disk(world: Any, body: str, prepare: str) -> Any:
    """Start a launch whose logs are on a disk of 2 MB, in which `prepare` is done before: `$1` is its folder."""
    logs = world.folder / "full"
    logs.mkdir()
    command = f'mount -t tmpfs -o size=2m none "$1" || exit; {prepare}\nshift; exec "$@"'
    inside = ["unshare", "-m", "sh", "-c", command, "sh", str(logs)]
    if subprocess.run(
        [*inside[:4], 'mount -t tmpfs none "$1"', "sh", logs], check=False, capture_output=True
    ).returncode:
        pytest.skip("mounting a small disk takes rights that are not there")
    world.environment["ROS_LOG_DIR"] = str(logs)
    return world.start([*inside, sys.executable, "-m", "ur", "launch", world.write(body)])


def test_full_disk_is_the_first_thing_reported_and_nothing_starts(world: Any) -> None:
    body = '<node pkg="little_nodes" type="sleeper" name="sleeper"/>'
    run = start_on_small_disk(world, body, 'head -c 1800K /dev/zero >"$1/rest"')
    assert run.wait() == 1
    first, help_line = run.text.splitlines()
    assert first == f"error: the disk of {world.folder}/full is full, expected 1 MB or more for logs [full-disk]"
    assert "ROS_LOG_DIR" in help_line
    wait_nothing_left(world.folder)


def test_disk_that_fills_loses_logs_not_the_run(world: Any) -> None:
    body = (
        '<node pkg="little_nodes" type="noisy" name="noisy" output="screen"/>'
        '<node pkg="little_nodes" type="sleeper" name="sleeper"/>'
    )
    fill, filled = world.folder / "fill", world.folder / "filled"
    os.mkfifo(fill)
    os.mkfifo(filled)
    run = start_on_small_disk(
        world, body, f'(read _ <{fill}; head -c 3M /dev/zero >"$1/rest"; echo >{filled}) </dev/null 2>&- &'
    )
    run.until("[/sleeper] started")
    fill.write_text("now\n")
    filled.read_text()
    run.until("[/noisy] line 300 of")
    run.process.send_signal(signal.SIGINT)
    assert run.wait() == 0
    assert "Traceback" not in run.text
    wait_nothing_left(world.folder)


def test_master_that_comes_back_gets_its_parameters_and_nodes_again(world: Any) -> None:
    from tests.run.conftest import start_master
    from tests.run.test_launch import get_parameter, registered

    first = start_master(world)
    run = world.launch(
        '<param name="x" value="1"/><node pkg="little_nodes" type="talker" name="talker" output="screen"/>'
    )
    run.until("] up")
    first.kill()
    first.wait()
    run.until("does not answer any more")
    second = start_master(world)
    try:
        run.until("another master answers: parameters are set again")
        while run.text.count("] up") < 2:
            assert run.read(5), run.text
        assert get_parameter(world.port, "/x") == 1
        assert "/talker" in registered(world.port)
        run.process.send_signal(signal.SIGINT)
        assert run.wait() == 0
        assert "/talker" not in registered(world.port)
    finally:
        second.terminate()
        second.wait()


@pytest.mark.usefixtures("master")
def test_nothing_of_50_nodes_survives_kill_9(world: Any) -> None:
    kinds = ("sleeper", "stubborn", "daemon", "double", "deaf")
    run = world.launch("".join(f'<node pkg="little_nodes" type="{kinds[n % 5]}" name="n{n}"/>' for n in range(50)))
    run.until("[/n49] started")
    # 10 each: stubborn has a sleep below it, daemon and double leave another process behind.
    while sum("sleep 600" in line for line in find_processes(world.folder).values()) < 40:
        run.read()
    os.kill(run.process.pid, signal.SIGKILL)
    wait_nothing_left(world.folder, without=frozenset({world.master_pid}))
