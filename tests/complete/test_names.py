"""What an argument may be: robots, selections, programs, runs and their nodes."""

import os
from dataclasses import replace
from pathlib import Path

import pytest
from tests.run.record.test_registry import entry_of

from ur.complete.names import (
    follow_selection,
    list_robots,
    list_run_names,
    list_running_nodes,
    list_selections,
    program_launch_file,
)
from ur.robot.discovery.record import RobotRecord, records_folder, render_record
from ur.run.record.registry import read_computer, register_run, unregister_run


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    folders = {name: str(tmp_path / name) for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_RUNTIME_DIR")}
    return {**os.environ, **folders, "HOME": str(tmp_path)}


def test_robots_are_those_that_were_set_up(environment: dict[str, str]) -> None:
    folder = records_folder(environment)
    folder.mkdir(parents=True)
    for record in (RobotRecord("bob", "ros", "magni"), RobotRecord("eve", "ros", "botvac", "xv11")):
        (folder / f"{record.name}.yaml").write_text(render_record(record))
    assert [(each.text, each.help) for each in list_robots(environment)] == [("bob", "magni"), ("eve", "botvac xv11")]


def test_selections_are_the_simulated_robot_of_each_base_and_variant() -> None:
    selections = [each.text for each in list_selections()]
    assert selections[0] == "sim"
    assert {"sim:stage", "sim:magni", "sim:botvac:xv11"} <= set(selections)


def test_program_leads_to_its_launch_file_and_an_unknown_one_to_none(environment: dict[str, str]) -> None:
    path = program_launch_file("keyboard_drive", environment)
    assert path is not None
    assert path.endswith("m_keyboard_drive.launch.xml")
    assert program_launch_file("nothing_of_this_name", environment) is None


def test_selection_sets_variables(environment: dict[str, str]) -> None:
    assert follow_selection(environment)["ROS_MASTER_URI"]


def test_runs_and_their_nodes_with_log_files_are_offered(environment: dict[str, str], tmp_path: Path) -> None:
    logs = tmp_path / "logs"
    logs.mkdir()
    for name in ("amcl-3-stdout.log", "master.log"):
        (logs / name).touch()
    here = read_computer()
    entry = replace(entry_of(os.getpid()), log_folder=str(logs), machine=here.machine, boot=here.boot, host=here.host)
    registered = register_run(entry, environment, os.getuid())
    assert registered is not None
    entry, listener = registered
    try:
        assert [each.text for each in list_run_names(environment)] == [entry.run]
        assert [each.text for each in list_running_nodes(environment)] == ["amcl-3"]
    finally:
        unregister_run(entry)
        listener.close()
