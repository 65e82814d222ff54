"""Verbs that take several robots: which ones they mean, and what they print about robots that are not there."""

import json
import os
from pathlib import Path

import click
import pytest
from tests.forking import run_ur
from tests.terminal import TmuxTerminal

from ur.cli.robots.fleet import choose_robots, read_names
from ur.robot.discovery.record import RobotRecord, load_records, render_record
from ur.source.diagnostic import UserError


@pytest.fixture
def records(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A user who has set up bob and eve."""
    folder = tmp_path / "config/ubiquity_launches/robots"
    folder.mkdir(parents=True)
    for name in ("bob", "eve"):
        (folder / f"{name}.yaml").write_text(f'name: "{name}"\nuser: "ros"\nbase: "magni"\n')
    for variable in ("CONFIG", "STATE"):
        monkeypatch.setenv(f"XDG_{variable}_HOME", str(tmp_path / variable.lower()))


@pytest.mark.usefixtures("records")
def test_robots_are_named_apart_or_by_commas_and_nobody_twice() -> None:
    assert choose_robots(["eve,bob", "kit"], every=False) == ("eve", "bob", "kit")
    assert choose_robots(["bob", "bob.local", "ros@bob", "ros@eve"], every=False) == ("bob", "ros@eve")
    assert choose_robots([], every=True) == ("bob", "eve")
    assert choose_robots([], every=False) == ()
    assert read_names(["ros@bob.local,eve"]) == {"bob", "eve"}


@pytest.mark.usefixtures("records")
def test_all_beside_a_name_and_what_is_no_address_are_refused() -> None:
    with pytest.raises(click.UsageError, match="expected no name beside it"):
        choose_robots(["bob"], every=True)
    with pytest.raises(UserError, match="not an address"):
        choose_robots(["bob", "e e"], every=False)


def test_all_without_any_robot_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    with pytest.raises(UserError, match="no robot was set up"):
        choose_robots([], every=True)


@pytest.mark.usefixtures("records")
def test_robots_that_are_not_there_fail_each_in_its_line_and_the_reason_follows() -> None:
    done = run_ur("boot", "status", "--robot", "nobody-1.invalid", "--robot", "nobody-2.invalid")
    assert done.returncode == 2
    lines = done.stdout.splitlines()
    first = sorted(line.partition(" after ")[0] for line in lines[:2])
    assert first == ["nobody-1.invalid: failed (2)", "nobody-2.invalid: failed (2)"]
    assert lines[2] == "nobody-1.invalid:"
    assert lines[3].startswith("  error: ros@nobody-1.invalid")
    assert lines[-1] == "0 of 2 robots ok; failed: nobody-1.invalid, nobody-2.invalid"
    assert "Traceback" not in done.stdout + done.stderr


@pytest.mark.usefixtures("records")
def test_output_of_a_robot_stays_in_a_file() -> None:
    run_ur("sync", "nobody-1.invalid,nobody-2.invalid", "--yes")
    log = Path(os.environ["XDG_STATE_HOME"], "ubiquity_launches/fleet/sync-nobody-2.invalid.log")
    assert log.read_text().startswith("error: ros@nobody-2.invalid")


@pytest.mark.usefixtures("records")
def test_json_of_several_robots_is_one_list() -> None:
    done = run_ur("doctor", "nobody-1.invalid,nobody-2.invalid", "--json")
    rows = json.loads(done.stdout)
    assert [row["robot"] for row in rows] == ["nobody-1.invalid", "nobody-2.invalid"]
    assert [row["code"] for row in rows] == [2, 2]
    assert all("findings" in row for row in rows)
    assert done.returncode == 2


def test_terminal_shows_one_line_for_each_robot_and_control_c_ends_all(tmp_path: Path) -> None:
    # An ssh that never answers, until it is ended.
    slow = tmp_path / "bin/ssh"
    slow.parent.mkdir()
    slow.write_text("#!/bin/sh\nexec sleep 600\n")
    slow.chmod(0o755)
    home = tmp_path / "home"
    home.mkdir()
    terminal = TmuxTerminal(["bash", "--noprofile", "--norc", "-i"], home, {"PS1": "$ "})
    try:
        line = f"PATH={slow.parent}:$PATH ur boot status --robot bob.invalid,eve.invalid; echo en''ded $?"
        terminal.type(f"clear; {line}", "Enter")
        terminal.until("eve.invalid running")
        screen = terminal.until("running 1 s")
        assert screen.count("bob.invalid running") == 1
        assert screen.count("eve.invalid running") == 1
        terminal.type("C-c")
        screen = terminal.until("ended 130")
        assert "0 of 2 robots ok; interrupted: bob.invalid, eve.invalid" in screen
        assert "Traceback" not in screen
        assert screen.count("bob.invalid interrupted") == 1
    finally:
        terminal.close()


@pytest.mark.usefixtures("records")
def test_passwords_of_access_points_are_printed_from_the_records_without_a_network(tmp_path: Path) -> None:
    folder = tmp_path / "config/ubiquity_launches/robots"
    record = RobotRecord("eve", "ros", "magni", access_point="abcd-efgh-jkmn")
    (folder / "eve.yaml").write_text(render_record(record))
    assert record in load_records(folder)
    assert run_ur("robots", "--access-points").stdout == "WiFi eve: password abcd-efgh-jkmn\n"
    done = run_ur("robots", "bob", "--access-points")
    assert (done.returncode, "sudo cat /etc/ubiquity/access-point" in done.stdout) == (1, True)
