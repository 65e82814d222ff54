"""Launches beside nodes of another run of this computer: they use them, or are refused; they never end them."""

import json
import os
import signal
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import free_port
from tests.run.leftovers import wait_nothing_left

pytestmark = pytest.mark.ros
SLEEPER = '<node pkg="little_nodes" type="sleeper" name="{}" args="{}"><!--ready: process--></node>'
NODES = SLEEPER.format("one", "") + SLEEPER.format("two", "")
TALKER = '<node pkg="little_nodes" type="talker" name="talker"{}/>'


def read_ended(world: Any) -> dict[str, Any]:
    return {each["run"]: each for each in json.loads(world.call("ps", "--ended", "--json"))}


def test_launch_whose_nodes_all_run_already_is_refused_by_the_name_of_their_run(world: Any) -> None:
    file = world.write(NODES)
    run = world.call("launch", "--detach", file).split()[-1]
    said = world.call("launch", "--detach", file, code=1)
    assert f"error: all nodes of this launch file already run in {run}: /one, /two [node-runs-already]" in said
    assert f"help: 'ur attach {run}' shows it, 'ur stop {run}' ends it; --replace starts it anew" in said
    assert world.call("ps").count("detached") == 1
    world.call("stop", "--all")
    wait_nothing_left(world.folder)


def test_launch_that_would_end_nodes_of_another_run_is_refused_by_its_name(world: Any) -> None:
    run = world.call("launch", "--detach", world.write(NODES)).split()[-1]
    other = world.write(SLEEPER.format("one", "here") + SLEEPER.format("three", ""), "other.launch")
    said = world.call("launch", "--detach", other, code=1)
    assert f"error: /one of run {run} would end, expected nodes that do not run yet [node-runs-already]" in said
    assert f"help: 'ur stop {run}' ends it; --except /one leaves out what runs; --replace starts it anyway" in said
    assert world.call("ps").count("detached") == 1
    world.call("stop", "--all")
    wait_nothing_left(world.folder)


@pytest.mark.usefixtures("master")
def test_launch_that_would_end_a_node_that_nobody_here_has_started_is_refused(world: Any) -> None:
    talker = world.start([str(world.folder / "little_nodes/nodes/talker")])
    talker.until("up")
    said = world.call("launch", world.write(TALKER.format("")), code=1)
    assert "error: /talker, which 'ur' has not started here, would end" in said
    assert "'rosnode kill /talker' ends what runs" in said
    assert talker.process.poll() is None


def test_launch_uses_nodes_that_run_as_it_defines_them_and_ends_only_its_own(world: Any) -> None:
    first = world.call("launch", "--detach", world.write(NODES)).split()[-1]
    more = world.write(NODES + SLEEPER.format("three", ""), "more.launch")
    said = world.call("launch", "--detach", more)
    assert f"using /one, /two of {first}" in said
    second = said.split()[-1]
    runs = {each["run"]: each for each in json.loads(world.call("ps", "--json"))}
    assert runs[second]["joined"] == [first]
    assert f"{first} has ended" not in world.call("stop", second)
    [left] = json.loads(world.call("ps", "--json"))
    assert left["run"] == first
    world.call("stop")
    wait_nothing_left(world.folder)


def test_run_that_has_joined_ends_with_1_when_the_first_is_stopped_and_both_say_so(world: Any) -> None:
    first = world.call("launch", "--detach", world.write(NODES)).split()[-1]
    second = world.ur("launch", world.write(NODES + SLEEPER.format("three", ""), "more.launch"))
    second.until("[/three] started")
    name = f"more.{second.process.pid}"
    assert f"{first} has ended; {name} had joined it and ends, too" in world.call("stop")
    assert second.wait() == 1
    assert f"error: {first}, which this run had joined, ends: asked by 'ur stop'" in second.text
    wait_nothing_left(world.folder)
    ended = read_ended(world)
    assert f"{name} had joined it and ends, too" in ended[first]["lines"]
    assert ended[name]["exit_code"] == 1
    assert ended[name]["cause"] == f"{first}, which this run had joined, ends: asked by 'ur stop'"


def test_run_that_has_joined_ends_when_the_first_is_killed(world: Any) -> None:
    first = world.ur("launch", world.write(NODES))
    first.until("[/one] started", "[/two] started")
    second = world.ur("launch", world.write(NODES + SLEEPER.format("three", ""), "more.launch"))
    second.until("[/three] started")
    first.process.kill()
    assert second.wait() == 1
    assert f"error: test.{first.process.pid}, which this run had joined, was killed" in second.text
    wait_nothing_left(world.folder)
    assert read_ended(world)[f"test.{first.process.pid}"]["exit_code"] is None
    assert "its process was killed" in world.call("ps", "--ended")


def test_first_run_goes_on_when_one_that_has_joined_is_ended_by_ctrl_c(world: Any) -> None:
    first = world.ur("launch", world.write(NODES))
    first.until("[/two] started")
    for _ in range(2):
        second = world.ur("launch", world.write(NODES + SLEEPER.format("three", ""), "more.launch"))
        second.until("[/three] started")
        second.process.send_signal(signal.SIGINT)
        assert second.wait() == 0
    assert first.process.poll() is None
    first.process.send_signal(signal.SIGINT)
    assert first.wait() == 0
    assert "had joined" not in first.text


def test_launch_waits_for_the_end_of_a_run_that_is_stopping_and_starts_everything(world: Any) -> None:
    stubborn = '<node pkg="little_nodes" type="stubborn" name="stubborn"/>'
    first = world.ur("launch", world.write(NODES + stubborn))
    first.until("[/one] started", "trapped")
    first.process.send_signal(signal.SIGINT)
    first.until("stopping: SIGINT")
    said = world.call("launch", "--detach", world.write(NODES + SLEEPER.format("three", ""), "more.launch"))
    assert f"waiting for the end of test.{first.process.pid}, which is stopping" in said
    assert "master started here" in said
    assert "using" not in said
    assert first.wait() == 0
    world.call("stop")
    wait_nothing_left(world.folder)


def test_programs_that_start_at_once_share_what_they_have_in_common(world: Any) -> None:
    files = [world.write(NODES + SLEEPER.format(name, ""), f"{name}.launch") for name in ("three", "four", "five")]
    runs = [world.ur("launch", file) for file in files]
    for name, run in zip(("three", "four", "five"), runs, strict=True):
        run.until(f"[/{name}] started")
    assert sum("master started here" in run.text for run in runs) == 1
    assert sum(run.text.count("[/one] started") for run in runs) == 1
    assert sum("using /one, /two of " in run.text for run in runs) == 2
    world.call("stop", "--all")
    assert sorted(run.wait() for run in runs) in ([0, 0, 0], [0, 0, 1], [0, 1, 1])
    wait_nothing_left(world.folder)


@pytest.mark.parametrize("option", ["--replace", "--only=/two"])
def test_launch_goes_on_where_it_is_meant_or_ends_nothing(world: Any, option: str) -> None:
    file = world.write(NODES)
    world.call("launch", "--detach", "--only=/one", file)
    world.call("launch", "--detach", option, file)
    assert world.call("ps").count("detached") == 2
    world.call("stop", "--all")
    wait_nothing_left(world.folder)


def test_nodes_at_another_master_are_not_taken_for_the_same(world: Any) -> None:
    file = world.write(NODES)
    world.call("launch", "--detach", file)
    world.environment["ROS_MASTER_URI"] = f"http://localhost:{free_port()}"
    world.call("launch", "--detach", file)
    world.call("stop", "--all")
    wait_nothing_left(world.folder)


@pytest.mark.parametrize("attributes", ["", ' respawn="true"', ' required="true"'])
def test_run_whose_node_is_replaced_says_by_whom_and_ends_with_1(world: Any, attributes: str) -> None:
    first = world.ur("launch", world.write(TALKER.format(attributes + ' output="screen"')))
    first.until("up")
    usurper = world.ur("launch", "--replace", world.write(TALKER.format(""), "usurper.launch"))
    assert first.wait() == 1
    by = f"run usurper.{usurper.process.pid}"
    assert f"error: /talker was ended by {by}, which started another node of this name" in first.text
    assert first.text.count("[/talker] started") == 1  # or the two would end each other in turn
    usurper.process.send_signal(signal.SIGINT)
    usurper.wait()
    wait_nothing_left(world.folder)


def test_run_whose_node_is_replaced_by_a_program_that_ur_does_not_know_names_its_process(world: Any) -> None:
    first = world.ur("launch", world.write(TALKER.format(' output="screen"')))
    first.until("up")
    talker = world.start([str(world.folder / "little_nodes/nodes/talker"), "__name:=talker"])
    assert first.wait() == 1
    assert f"error: /talker was ended by process {talker.process.pid}, which" in first.text


def test_detached_run_that_has_ended_is_found_with_reason_and_last_lines(world: Any) -> None:
    body = '<node pkg="little_nodes" type="crash" name="crash" required="true"/>' + NODES
    run = world.call("launch", "--detach", world.write(body)).split()[-1]
    wait_nothing_left(world.folder)
    assert "/crash is required and has ended" in world.call("ps", "--ended")
    ended = read_ended(world)[run]
    assert (ended["exit_code"], ended["detached"]) == (0, True)
    said = world.call("logs")  # nothing runs: the latest
    assert f"{run} ended " in said
    assert "/crash died: exit code 3" in said
    assert "last words" in world.call("logs", "--run", run, "crash")
    said = world.call("attach", run, code=2)
    assert f"'ur logs --run {run}' prints its last lines" in said


def test_only_the_latest_ended_runs_are_kept(world: Any) -> None:
    from ur.run.record.registry import MAX_RUNS

    file = world.write('<node pkg="little_nodes" type="quick" name="quick"/>')
    run = world.ur("launch", file)
    assert run.wait() == 0
    folder = Path(world.environment["XDG_STATE_HOME"], "ur", "ended")
    [kept] = folder.glob("*.json")
    for number in range(MAX_RUNS + 5):
        copy = folder / f"old.{number}.json"
        copy.write_text(kept.read_text().replace(f"test.{run.process.pid}", f"old.{number}"))
        os.utime(copy, (number, number))
    assert world.ur("launch", file).wait() == 0
    names = {path.name for path in folder.glob("*.json")}
    assert len(names) == MAX_RUNS
    assert kept.name in names
    assert "old.0.json" not in names


def test_port_of_the_command_line_chooses_the_master_that_is_joined(world: Any) -> None:
    run = world.call("launch", "--detach", world.write(NODES)).split()[-1]
    other = str(free_port())
    assert "using" not in world.call("launch", "--detach", "-p", other, world.write(NODES))
    more = world.write(NODES + SLEEPER.format("three", ""), "more.launch")
    world.environment["ROS_MASTER_URI"] = f"http://localhost:{other}"
    assert f"of {run}" in world.call("launch", "--detach", "-p", str(world.port), more)
    world.call("stop", "--all")
    wait_nothing_left(world.folder)
