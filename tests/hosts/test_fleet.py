"""Commands for several robots at once, on two that were set up and one that is away."""

import json
from collections.abc import Iterator

import pytest
from tests.hosts.bench import UR, Bench, Done, boot
from tests.hosts.test_robot_setup import PASSWORD, prepare, set_up_two

ROBOTS = {"bob": "robot", "eve": "robot2"}


@pytest.fixture(scope="module")
def three() -> Iterator[Bench]:
    """A laptop, and the robots bob and eve that were set up from it."""
    with boot(("laptop", "robot", "robot2")) as bench:
        prepare(bench["laptop"])
        set_up_two(bench["laptop"])
        yield bench


def ur(three: Bench, words: str, stdin: str = "") -> Done:
    return three["laptop"].run(f"{UR} {words}", user="pat", stdin=stdin, timeout=300)


def add_package(three: Bench, name: str) -> None:
    path = f"catkin_ws/src/{name}"
    line = f"mkdir -p {path} && echo '<package><name>{name}</name></package>' >{path}/package.xml"
    three["laptop"].run(line, user="pat").check()


def test_named_robots_are_listed_and_a_stranger_is_away(three: Bench) -> None:
    three["laptop"].wait_for(f"{UR} robots bob eve", user="pat", deadline=120)
    done = ur(three, "robots bob nobody --json")
    rows = {row["name"]: row["address"] for row in json.loads(done.out)}
    assert rows == {"bob": three["robot"].address, "nobody": ""}
    assert done.code == 1


def test_doctor_examines_all_and_one_that_is_away_fails_alone(three: Bench) -> None:
    done = ur(three, "doctor bob eve nobody")
    lines = done.out.splitlines()
    assert sorted(line.split(":")[0] for line in lines[:3]) == ["bob", "eve", "nobody"]
    assert done.code == 2
    assert lines[-1].endswith("failed: nobody")
    seen = json.loads(three["laptop"].read("/home/pat/.local/state/ubiquity_launches/seen.json"))
    assert {row["name"] for row in seen} >= {"bob", "eve"}
    rows = json.loads(ur(three, "doctor --all --json").out)
    assert [(row["robot"], row["findings"]) for row in rows] == [("bob", []), ("eve", [])]


def test_workspaces_are_synced_after_one_question(three: Bench) -> None:
    add_package(three, "tool")
    refused = ur(three, "sync --all")
    assert "no terminal to ask on" in refused.err
    assert "tool/package.xml" in refused.out
    for robot in ROBOTS.values():
        assert three[robot].run("ls /home/ros/catkin_ws/src").out == ""
    done = ur(three, "sync bob,eve --yes").check()
    assert done.out.splitlines()[-1] == "2 of 2 robots ok"
    assert ur(three, "sync --all --dry-run").check().out.count("in step with") >= 2


def test_boot_services_are_changed_on_all_with_one_password(three: Bench) -> None:
    line = "boot install --all --name sleeper --password-from 0 sleep 1000"
    assert ur(three, line, f"{PASSWORD}\n").check().out.splitlines()[-1] == "2 of 2 robots ok"
    for robot in ROBOTS.values():
        three[robot].wait_for("systemctl is-active ubiquity-sleeper", deadline=60)
    assert ur(three, "boot status --all").out.count("\n  sleeper: runs since") == 2
    ur(three, "boot remove --all --password-from 0 sleeper", f"{PASSWORD}\n").check()
    wrong = ur(three, "boot install --all --password-from 0 sleep 1", "wrong\n")
    assert wrong.code == 2
    assert wrong.out.count("sudo refuses this password") >= 2
    assert "wrong\n" not in three["laptop"].run("grep -rh wrong .local/state/ubiquity_launches/fleet", user="pat").out
