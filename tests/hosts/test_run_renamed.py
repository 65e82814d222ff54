"""A robot whose name or address changes during a run: the run is found, and no node starts beside it."""

import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.hosts.bench import UR, Bench, Done, Machine
from tests.hosts.managed import wait_settled
from tests.hosts.test_robot_setup import PASSWORD
from tests.hosts.test_run_on_robot import nodes_of, pair, started

__all__ = ["pair"]
NETWORK = "/etc/systemd/network/10-host0.network"


@pytest.fixture(autouse=True)
def called_bob(pair: Bench) -> Iterator[None]:
    """End what is left on the robot, and give it its name back."""
    yield
    pair["robot"].run("bash -lc 'ur stop --all'", user="ros")
    if pair["robot"].read("/etc/hostname") != "bob\n":
        rename(pair, "eve", "bob")


def rename(pair: Bench, old: str, new: str) -> None:
    line = f"{UR} robot rename {old} {new} --password-from 0"
    pair["laptop"].run(line, user="pat", stdin=f"{PASSWORD}\n", timeout=300).check()
    wait_settled(pair["robot"])
    pair["laptop"].wait_for("rosnode list", user="pat", deadline=60)


def on_robot(robot: Machine, words: str) -> Done:
    return robot.run(f"bash -lc '{words}'", user="ros")


def runs(robot: Machine) -> list[str]:
    return [line.split()[0] for line in on_robot(robot, "ur ps").check().out.splitlines()[1:]]


def kill_run(pair: Bench, tmp_path: Path) -> str:
    """Start the program on the laptop and kill it there; the robot's run that it leaves behind."""
    with started(pair, "launch chat chat.launch", tmp_path) as program:
        program.wait_said("laptop heard ")
        program.signal(signal.SIGKILL)
        program.process.wait(60)
    (run,) = runs(pair["robot"])
    return run


def test_run_is_listed_and_stopped_on_a_robot_that_was_renamed(pair: Bench, tmp_path: Path) -> None:
    run = kill_run(pair, tmp_path)
    rename(pair, "bob", "eve")
    assert runs(pair["robot"]) == [run]
    on_robot(pair["robot"], f"ur stop {run}").check()
    assert runs(pair["robot"]) == []
    assert nodes_of(pair["robot"]) == []


def test_run_of_the_laptop_ends_the_robots_under_its_new_name(pair: Bench, tmp_path: Path) -> None:
    with started(pair, "launch chat chat.launch", tmp_path) as program:
        program.wait_said("laptop heard ")
        (run,) = runs(pair["robot"])
        rename(pair, "bob", "eve")
        program.signal(signal.SIGINT)
        assert program.process.wait(90) == 0, program.said
        assert f"eve: {run} has ended" in program.said
    assert nodes_of(pair["robot"]) == []


def test_next_run_starts_the_nodes_again_under_the_new_name_and_no_second_ones(pair: Bench, tmp_path: Path) -> None:
    before = kill_run(pair, tmp_path)
    rename(pair, "bob", "eve")
    with started(pair, "launch chat chat.launch", tmp_path) as program:
        program.wait_said("laptop heard ")
        assert "eve: its nodes ran under its old name bob and are started again" in program.said
        assert nodes_of(pair["robot"]) == ["talk.py"]
        assert before not in runs(pair["robot"])
        program.signal(signal.SIGINT)
        assert program.process.wait(90) == 0, program.said
    assert nodes_of(pair["robot"]) == []


def test_run_of_somebody_else_under_the_old_name_is_named_and_left_alone(pair: Bench) -> None:
    robot = pair["robot"]
    on_robot(robot, "ur launch --detach --wait --only talk chat chat.launch text:=own").check()
    (run,) = runs(robot)
    rename(pair, "bob", "eve")
    done = pair["laptop"].run(f"{UR} launch chat chat.launch", user="pat", timeout=120)
    assert done.code == 1
    assert f"error: eve: run {run} started /talk when eve was called bob" in done.err
    assert f"help: ur shell eve ur stop {run}" in done.err
    assert nodes_of(robot) == ["talk.py"]
    assert runs(robot) == [run]


def test_run_is_taken_over_at_another_address(pair: Bench, tmp_path: Path) -> None:
    robot = pair["robot"]
    run = kill_run(pair, tmp_path)
    settings = robot.read(NETWORK)
    try:
        robot.write(NETWORK, settings.replace(f"Address={robot.address}/", "Address=10.77.0.77/"))
        robot.run("networkctl reload && networkctl reconfigure host0").check()
        pair["laptop"].wait_for("getent ahostsv4 bob.local | grep -q 10.77.0.77", deadline=120)
        assert runs(robot) == [run]
        with started(pair, "launch chat chat.launch", tmp_path) as program:
            program.wait_said("laptop heard ")
            assert "is taken over" in program.said
            assert nodes_of(robot) == ["talk.py"]
            program.signal(signal.SIGINT)
            assert program.process.wait(90) == 0, program.said
        assert runs(robot) == []
    finally:
        robot.write(NETWORK, settings)
        robot.run("networkctl reload && networkctl reconfigure host0").check()
        pair["laptop"].wait_for(f"getent ahostsv4 bob.local | grep -q {robot.address}", deadline=120)
