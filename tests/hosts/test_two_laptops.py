"""One robot and two laptops: nobody takes the robot's nodes from the other, and everybody is told who drives."""

from __future__ import annotations

import json
import re
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from tests.hosts.bench import UR, Bench, Machine, boot, wait_until
from tests.hosts.test_robot_setup import PASSWORD, prepare, set_up
from tests.hosts.test_run_on_robot import Started, bring_package, link_project, nodes_of, runs_there, started

MORE = """\
<launch>
  <arg name="robot_machine" default="localhost"/>
  <machine name="localhost" address="localhost"/>
  <node machine="$(arg robot_machine)" name="talk" pkg="chat" type="talk.py"><param name="text" value="more"/></node>
  <node machine="$(arg robot_machine)" name="talk2" pkg="chat" type="talk.py"><param name="text" value="more"/></node>
  <node name="hear" pkg="chat" type="hear.py" output="screen"/>
</launch>
"""
QUIET = """\
<launch>
  <arg name="robot_machine" default="localhost"/>
  <machine name="localhost" address="localhost"/>
  <node machine="$(arg robot_machine)" name="quiet" pkg="chat" type="hear.py"/>
</launch>
"""
DRIVE = """\
<launch>
  <arg name="robot_machine" default="localhost"/>
  <machine name="localhost" address="localhost"/>
  <node machine="$(arg robot_machine)" name="talk" pkg="chat" type="talk.py"><param name="text" value="x"/></node>
  <node name="keys" pkg="chat" type="teleop_twist_keyboard.py" output="screen"/>
</launch>
"""
KEYS = """\
#!/usr/bin/python3
import os
import rospy
rospy.init_node("keys")
names = ("UR_LEASE", "UR_ATTENDED", "UR_CLIENT_NAME")
print("keys: " + " ".join(name + "=" + os.environ.get(name, "") for name in names), flush=True)
print("client: " + os.environ["UR_CLIENT"], flush=True)
rospy.spin()
"""
SET_LEASE = (
    "import sys, xmlrpc.client as c; c.ServerProxy('http://localhost:11311').setParam('/t', '/ur/lease', sys.argv[1])"
)
GET_LEASE = (
    "import xmlrpc.client as c; print(c.ServerProxy('http://localhost:11311').getParam('/t', '/ur/lease')[2] or {})"
)
HELD = {"state": "held", "client": "a1", "name": "laptop", "program": "keyboard_drive", "since": 1_790_000_000}


@pytest.fixture(scope="module")
def trio() -> Iterator[Bench]:
    """Two laptops that have selected the robot `bob`, which has this project; all have the package `chat`."""
    names = ("laptop", "laptop2", "robot")
    with boot(names, with_repository=names, programs=True) as bench:
        for name, host, current in (("laptop", "robot.local", "ros"), ("laptop2", "bob.local", PASSWORD)):
            prepare(bench[name])
            set_up(bench[name], host, current=current).check()
        link_project(bench["robot"])
        for machine in bench.machines.values():
            bring_package(machine)
            home = f"/home/{'ros' if machine.name == 'robot' else 'pat'}/catkin_ws/src/chat"
            machine.write(f"{home}/launch/more.launch", MORE)
            machine.write(f"{home}/launch/drive.launch", DRIVE)
            machine.write(f"{home}/launch/quiet.launch", QUIET)
            machine.write(f"{home}/scripts/teleop_twist_keyboard.py", KEYS, mode=0o755)
        for name in names[:2]:
            bench[name].run(f"{UR} use bob", user="pat").check()
            bench[name].wait_for("rosnode list", user="pat", deadline=120)
        yield bench


@pytest.fixture(autouse=True)
def clean(trio: Bench) -> Iterator[None]:
    yield
    for machine in trio.machines.values():
        machine.restore()
    trio["robot"].run("bash -lc 'ur stop --all'; rosparam delete /ur/lease", user="ros")


def plant_lease(trio: Bench, **changes: object) -> None:
    trio["robot"].run(["python3", "-c", SET_LEASE, json.dumps({**HELD, **changes})], user="ros").check()


def end(program: Started) -> str:
    """End a program as Ctrl-C does; what it said."""
    program.signal(signal.SIGINT)
    assert program.process.wait(90) == 0, program.said
    return program.said


def read_lease(robot: Machine) -> dict[str, Any]:
    """The lease as the multiplexer has mirrored it; empty while there is none."""
    done = robot.run(["python3", "-c", GET_LEASE], user="ros")
    return dict(json.loads(done.out)) if done.code == 0 else {}


@contextmanager
def started_on_terminal(machine: Machine, words: str, tmp_path: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A program of `ur` that owns a terminal; its standard input is the keyboard."""
    line = f"export TERM=xterm; exec script -qec '{UR} {words}' /dev/null"
    with (tmp_path / f"screen-{machine.name}").open("wb") as screen:
        process = subprocess.Popen(
            machine.command_line(line, user="pat"),
            stdin=subprocess.PIPE,
            stdout=screen,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
    try:
        yield process
    finally:
        if process.poll() is None:
            machine.run("pkill -KILL -u pat -f '^[^ ]*python -I -m ur launch'")
        process.communicate(timeout=60)


def press(program: subprocess.Popen[bytes], keys: bytes) -> None:
    """Press keys."""
    assert program.stdin is not None
    program.stdin.write(keys)
    program.stdin.flush()


def stop(program: subprocess.Popen[bytes]) -> None:
    """Press Ctrl-C."""
    press(program, b"\x03")
    program.wait(90)


def read_screen(folder: Path, name: str) -> str:
    """Everything that the terminal of a laptop was sent, without control sequences."""
    text = (folder / f"screen-{name}").read_bytes().decode("utf-8", "replace")
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", text)


@pytest.mark.parametrize("first", ["laptop", "laptop2"])
def test_run_of_the_robot_ends_with_its_last_client_in_either_order(trio: Bench, tmp_path: Path, first: str) -> None:
    with (
        started(trio, "launch chat chat.launch", tmp_path) as one,
        started(trio, "launch chat chat.launch", tmp_path, "laptop2") as two,
    ):
        one.wait_said("laptop heard ")
        two.wait_said("laptop2 heard ")
        (run,) = runs_there(trio)
        goes, stays = (one, two) if first == "laptop" else (two, one)
        other = "laptop2" if first == "laptop" else "laptop"
        assert f"bob: {run} goes on for {other}" in end(goes)
        stays.wait_said(f"{other} heard ", after=len(stays.said))
        assert runs_there(trio) == [run]
        assert nodes_of(trio["robot"]) == ["talk.py"]
        assert f"bob: {run} has ended" in end(stays)
    assert runs_there(trio) == []
    assert [nodes_of(machine) for machine in trio.machines.values()] == [[], [], []]


def test_second_laptop_is_told_of_the_first_and_its_node_gets_another_name(trio: Bench, tmp_path: Path) -> None:
    with started(trio, "launch chat chat.launch", tmp_path) as one:
        one.wait_said("laptop heard ")
        with started(trio, "launch chat chat.launch", tmp_path, "laptop2") as two:
            two.wait_said("laptop2 heard ")
            assert "/hear runs on another computer already, so this one is called /hear_laptop2" in two.said
            assert "which laptop uses too" in two.said
            named = trio["robot"].run("bash -lc 'rosnode list; rosparam list'", user="ros").check().out.split()
            assert {"/hear", "/hear_laptop2", "/hear/own", "/hear_laptop2/own"} <= set(named)
            one.wait_said("laptop heard ", after=len(one.said))
            end(two)
        one.wait_said("laptop heard ", after=len(one.said))
        end(one)


def test_client_that_was_killed_does_not_keep_the_run(trio: Bench, tmp_path: Path) -> None:
    with started(trio, "launch chat chat.launch", tmp_path) as one:
        one.wait_said("laptop heard ")
        with started(trio, "launch chat chat.launch", tmp_path, "laptop2") as two:
            two.wait_said("laptop2 heard ")
            two.signal(signal.SIGKILL)
            two.process.wait(60)
        one.wait_said("laptop heard ", after=len(one.said))
        end(one)
    # It may have been cut off, or have just begun, so it is given a minute.
    wait_until(lambda: runs_there(trio) == [], "the run has ended", 120)
    assert nodes_of(trio["robot"]) == []


def test_client_that_is_cut_off_finds_its_run_again(trio: Bench, tmp_path: Path) -> None:
    with (
        started(trio, "launch chat chat.launch", tmp_path) as one,
        started(trio, "launch chat chat.launch", tmp_path, "laptop2") as two,
    ):
        one.wait_said("laptop heard ")
        two.wait_said("laptop2 heard ")
        (run,) = runs_there(trio)
        trio["laptop2"].cut()
        assert f"bob: {run} goes on for laptop2" in end(one)
        trio["laptop2"].restore()
        two.wait_said("laptop2 heard ", after=len(two.said))
        assert runs_there(trio) == [run]
        assert f"bob: {run} has ended" in end(two)
    assert runs_there(trio) == []


@pytest.mark.parametrize("how", ["ends", "is killed"])
def test_run_without_nodes_of_the_laptops_is_theirs_too(trio: Bench, tmp_path: Path, how: str) -> None:
    with started(trio, "launch chat quiet.launch", tmp_path) as one:
        one.wait_said("/quiet] running")
        with started(trio, "launch chat quiet.launch", tmp_path, "laptop2") as two:
            two.wait_said("/quiet] running")
            (run,) = runs_there(trio)
            if how == "ends":
                assert f"bob: {run} goes on for laptop" in end(two)
            else:
                two.signal(signal.SIGKILL)
                two.process.wait(60)
        assert runs_there(trio) == [run]
        end(one)
    # A client that was killed may have been cut off, so it is given a minute.
    wait_until(lambda: runs_there(trio) == [], "the run has ended", 120)
    wait_until(lambda: not list_ssh(trio["laptop2"]), "nothing is left on laptop2", 60)


def list_ssh(laptop: Machine) -> list[str]:
    return [words for _, words in laptop.processes() if words.startswith("ssh ") and "attach" in words]


def test_nodes_that_another_program_relies_on_go_on(trio: Bench, tmp_path: Path) -> None:
    with started(trio, "launch chat chat.launch", tmp_path) as one:
        one.wait_said("laptop heard ")
        (run,) = runs_there(trio)
        with started(trio, "launch chat more.launch", tmp_path, "laptop2") as two:
            two.wait_said("laptop2 heard ")
            assert "bob: 1 node runs already: /talk" in two.said
            assert "bob: laptop uses these nodes too" in two.said
            assert nodes_of(trio["robot"]) == ["talk.py", "talk.py"]
            assert f"bob: {run} goes on for laptop2" in end(one)
            two.wait_said("laptop2 heard ", after=len(two.said))
            end(two)
    assert runs_there(trio) == []
    assert nodes_of(trio["robot"]) == []


def test_who_drives_is_told_and_without_a_terminal_an_option_has_to_say_what_to_do(trio: Bench, tmp_path: Path) -> None:
    laptop2 = trio["laptop2"]
    plant_lease(trio)
    done = laptop2.run(f"{UR} launch chat drive.launch", user="pat", timeout=120)
    assert done.code == 1
    assert "error: laptop drives bob since" in done.err
    assert "(keyboard_drive)" in done.err
    assert "help: add --watch, --ask or --take-over" in done.err
    assert runs_there(trio) == []
    for option, mode in (("--watch", "watch"), ("--ask", "ask"), ("--take-over --unattended", "take")):
        with started(trio, f"launch chat drive.launch {option}", tmp_path, "laptop2") as program:
            program.wait_said("client: ")
            attended = 0 if "unattended" in option else 1
            assert f"keys: UR_LEASE={mode} UR_ATTENDED={attended} UR_CLIENT_NAME=laptop2" in program.said
            environment = next(
                Path(f"/proc/{number}/environ").read_bytes()
                for number, words in trio["robot"].processes()
                if words.startswith("/usr/bin/python3") and "talk.py" in words
            )
            assert b"UR_CLIENT" not in environment
            assert b"UR_LEASE" not in environment
            end(program)


def test_person_at_a_terminal_is_asked(trio: Bench) -> None:
    plant_lease(trio)
    line = f'script -qec "{UR} launch --plain chat drive.launch" /dev/null'
    done = trio["laptop2"].run(line, user="pat", stdin="q\n", timeout=120)
    assert "laptop drives bob since" in done.out
    assert "[w]atch, [a]sk to drive, [t]ake over, [q]uit?" in done.out
    assert done.code == 0
    assert runs_there(trio) == []


def test_robot_whose_driver_is_out_of_reach_is_taken_over_on_purpose_only(trio: Bench, tmp_path: Path) -> None:
    laptop2 = trio["laptop2"]
    plant_lease(trio, state="lost", until=1_790_000_060)
    done = laptop2.run(f"{UR} launch chat drive.launch", user="pat", timeout=120)
    assert done.code == 1
    assert "error: laptop drove bob until" in done.err
    assert "(keyboard_drive) and is out of reach" in done.err
    assert "help: add --watch or --take-over" in done.err
    assert runs_there(trio) == []
    line = f'script -qec "{UR} launch --plain chat drive.launch" /dev/null'
    done = laptop2.run(line, user="pat", stdin="q\n", timeout=120)
    assert "and is out of reach" in done.out
    assert "[w]atch, [t]ake over, [q]uit?" in done.out
    # The laptop itself begins again at once: its program was killed, for instance.
    with started(trio, "launch chat drive.launch", tmp_path, "laptop") as program:
        program.wait_said("client: ")
        assert "keys: UR_LEASE=drive" in program.said
        end(program)


@pytest.mark.parametrize("change", [{"state": "free"}, {"name": "x" * 100}])
def test_robot_that_nobody_drives_is_driven_at_once(trio: Bench, tmp_path: Path, change: dict[str, object]) -> None:
    plant_lease(trio, **change)
    with started(trio, "launch chat drive.launch", tmp_path, "laptop2") as program:
        program.wait_said("client: ")
        assert "keys: UR_LEASE=drive UR_ATTENDED=1" in program.said
        end(program)


def test_driver_of_a_real_program_is_named_to_the_second_laptop(trio: Bench, tmp_path: Path) -> None:
    robot, words = trio["robot"], "run keyboard_drive simulate:=true"
    with started_on_terminal(trio["laptop"], words, tmp_path) as driver:
        wait_until(lambda: read_lease(robot).get("name") == "laptop", "laptop drives", 90)
        assert read_lease(robot)["state"] == "held"
        done = trio["laptop2"].run(f"{UR} {words}", user="pat", timeout=120)
        assert done.code == 1
        assert "error: laptop drives bob since" in done.err
        with started_on_terminal(trio["laptop2"], f"{words} --take-over", tmp_path) as taker:
            wait_until(lambda: read_lease(robot).get("name") == "laptop2", "laptop2 drives", 90)
            (run,) = runs_there(trio)
            stop(driver)
            assert runs_there(trio) == [run]
            assert read_lease(robot)["name"] == "laptop2"
            stop(taker)
    assert runs_there(trio) == []


def test_laptop_that_is_cut_off_is_still_the_driver_for_the_second(trio: Bench, tmp_path: Path) -> None:
    robot, words = trio["robot"], "run keyboard_drive simulate:=true"
    with started_on_terminal(trio["laptop"], words, tmp_path) as driver:
        wait_until(lambda: read_lease(robot).get("name") == "laptop", "laptop drives", 90)
        trio["laptop"].cut()
        wait_until(lambda: read_lease(robot).get("state") == "lost", "laptop is lost", 60)
        done = trio["laptop2"].run(f"{UR} {words}", user="pat", timeout=120)
        assert done.code == 1
        assert "error: laptop drove bob until" in done.err
        with started_on_terminal(trio["laptop2"], f"{words} --watch", tmp_path) as watcher:
            wait_until(lambda: "is out of reach; d: take over" in read_screen(tmp_path, "laptop2"), "it is told", 90)
            trio["laptop"].restore()
            wait_until(lambda: read_lease(robot)["state"] == "held", "laptop drives again", 60)
            assert read_lease(robot)["name"] == "laptop"
            trio["laptop"].cut()
            wait_until(lambda: read_lease(robot)["state"] == "lost", "laptop is lost again", 60)
            press(watcher, b"d")
            wait_until(lambda: read_lease(robot).get("name") == "laptop2", "laptop2 drives", 60)
            trio["laptop"].restore()
            wait_until(lambda: "laptop2 took over at" in read_screen(tmp_path, "laptop"), "the first is told", 60)
            stop(watcher)
        stop(driver)
    assert runs_there(trio) == []
