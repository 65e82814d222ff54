"""`ur robots` and `ur doctor --wireless` between two computers, also while a robot is away."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.hosts.bench import UR, Bench, wait_until
from tests.hosts.managed import wait_settled
from tests.hosts.test_doctor import pair
from tests.hosts.test_robot_setup import PASSWORD
from tests.terminal import TmuxTerminal

__all__ = ["pair"]
SECONDS = 120.0


def list_robots(pair: Bench) -> dict[str, Any]:
    said = pair["laptop"].run(f"{UR} robots --json --seconds 4", user="pat").out
    return {row["name"]: row for row in json.loads(said)}


def until_listed(pair: Bench, key: str, value: object) -> dict[str, Any]:
    """Bob's row once it says so."""
    rows: dict[str, Any] = {}

    def says_so() -> bool:
        rows.update(list_robots(pair))
        return "bob" in rows and rows["bob"][key] == value

    wait_until(says_so, f"{key} is {value!r}", SECONDS)
    row: dict[str, Any] = rows["bob"]
    return row


@pytest.fixture
def terminal(pair: Bench, tmp_path: Path) -> Iterator[TmuxTerminal]:
    """A shell of pat's on the laptop, with a terminal of its own, so that Ctrl-C reaches what runs in it."""
    shell = "exec script -q -c 'bash --norc -i' /dev/null"
    opened = TmuxTerminal(pair["laptop"].command_line(shell, user="pat", environment={"PS1": "$ "}), tmp_path)
    try:
        yield opened
    finally:
        opened.close()


def test_list_tells_what_robots_are_how_their_clock_is_and_what_they_run(pair: Bench) -> None:
    laptop = pair["laptop"]
    laptop.run(f"{UR} boot install --robot bob", user="pat", timeout=120).check()
    row = until_listed(pair, "services", {"master": "active"})
    assert (row["base"], row["address"], row["problem"]) == ("magni", pair["robot"].address, "")
    assert abs(row["clock_offset"]) < 0.5
    assert row["version"]
    assert until_listed(pair, "nodes", 1)  # rosout
    shown = laptop.run(f"{UR} robots", user="pat").check().out
    assert "magni" in shown
    assert "here" in shown


def test_robot_that_is_starting_is_listed_with_its_nodes_and_its_clock(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.run(f"{UR} boot install --robot bob", user="pat", timeout=120).check()
    until_listed(pair, "nodes", 1)
    robot.run("systemctl restart --no-block ubiquity-master").check()
    check_whole(pair, "bob")
    leader = robot.leader
    robot.run("systemctl reboot")
    robot.wait_rebooted(leader)
    check_whole(pair, "bob")
    # Renamed from elsewhere: this computer has no host key of that name.
    kept = laptop.run("tar c .ssh .config | base64", user="pat").check().out
    for old, new in (("bob", "eve"), ("eve", "bob")):
        line = f"{UR} robot rename {old} {new} --password-from 0"
        laptop.run(line, user="pat", stdin=f"{PASSWORD}\n", timeout=300).check()
        wait_settled(robot)
        check_whole(pair, new)
        if new == "eve":
            known = laptop.run("tar c .ssh .config | base64", user="pat").check().out
            laptop.run("rm -rf .ssh .config; base64 -d | tar x", user="pat", stdin=kept).check()
            row = check_whole(pair, "eve")
            assert row["problem"] == "eve was renamed: this computer knows it as bob"
            assert row["help"] == "ur robot rename bob eve"
            laptop.run("rm -rf .ssh .config; base64 -d | tar x", user="pat", stdin=known).check()


def check_whole(pair: Bench, name: str) -> dict[str, Any]:
    """The row of a robot in the first list that has it: its clock is known, and its nodes once its master answers."""
    rows: dict[str, Any] = {}

    def is_listed() -> bool:
        rows.update(list_robots(pair))
        return name in rows and bool(rows[name]["address"])

    wait_until(is_listed, f"{name} is listed", SECONDS)
    row: dict[str, Any] = rows[name]
    assert row["clock_offset"] is not None, str(row)
    assert row["services"], str(row)

    def has_nodes() -> bool:
        rows.update(list_robots(pair))
        return bool(rows[name]["nodes"])

    wait_until(has_nodes, f"{name}'s master answers", SECONDS)
    return row


def test_robot_that_is_away_is_listed_with_where_it_was(pair: Bench) -> None:
    until_listed(pair, "address", pair["robot"].address)
    pair["robot"].cut()
    try:
        row = until_listed(pair, "address", "")
        assert row["seen"]["address"] == pair["robot"].address
        assert "away" in pair["laptop"].run(f"{UR} robots", user="pat").out
    finally:
        pair["robot"].restore()
    until_listed(pair, "address", pair["robot"].address)


def test_link_is_measured_and_what_cannot_be_seen_is_said(pair: Bench) -> None:
    done = pair["laptop"].run(f"{UR} doctor --wireless bob --seconds 3", user="pat").check()
    assert "latency" in done.out
    assert "no wireless interface at laptop and bob: latency and loss only" in done.out


def test_gap_of_a_link_is_reported_and_measuring_goes_on(pair: Bench, terminal: TmuxTerminal) -> None:
    terminal.type(f"clear; {UR} doctor --wireless bob --watch --log walk.csv; echo en''ded", "Enter")
    terminal.until("good: ", SECONDS)
    pair["robot"].cut()
    try:
        terminal.until("bob has not answered", SECONDS)
    finally:
        pair["robot"].restore()

    def list_latencies() -> list[str]:
        head, *rows = pair["laptop"].read("/home/pat/walk.csv").splitlines()
        return [row.split(",")[head.split(",").index("latency_ms")] for row in rows]

    wait_until(lambda: list_latencies()[-1] != "", "it answers again", SECONDS)
    terminal.type("C-c")
    screen = terminal.until("ended", SECONDS)
    assert "away once" in screen
    assert "Traceback" not in screen
    latencies = list_latencies()
    assert "" in latencies
    assert latencies[0]
    assert latencies[-1]
    pair["laptop"].run("rm walk.csv", user="pat").check()
    left = [words for _, words in pair["laptop"].processes() if words.startswith(("ping ", "ssh "))]
    assert left == []


def test_line_is_printed_each_second(pair: Bench) -> None:
    done = pair["laptop"].run(f"{UR} doctor --wireless bob --watch --seconds 2", user="pat").check()
    assert done.out.count("  latency ") == 2


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("doctor --wireless nobody", "no computer answers to this name"),
        ("doctor --wireless", "no robot given"),
        ("doctor --wireless bob --log /no/such/folder/x", "cannot be written"),
        ("doctor --wireless 'b b'", "is not an address"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(pair: Bench, words: str, said: str) -> None:
    pair["laptop"].run(f"{UR} use sim", user="pat").check()  # the set-up has selected the robot
    done = pair["laptop"].run(f"{UR} {words}", user="pat")
    assert done.code == 2
    assert said in done.err
    assert "Traceback" not in done.err


def test_computer_that_took_the_name_of_a_robot_is_named(pair: Bench) -> None:
    pair.boot_stranger("bob")
    pair["laptop"].wait_for("getent ahostsv4 bob-2.local", deadline=60)
    named: list[str] = []

    def is_named() -> bool:
        named[:] = [row["problem"] for row in list_robots(pair).values() if row["problem"]]
        return bool(named)

    wait_until(is_named, "the namesake is named", SECONDS)
    assert "10.77.0.90" in named[0]
    assert "bob-2.local" in named[0]
