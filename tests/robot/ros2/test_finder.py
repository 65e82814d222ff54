"""The program that finds ROS 2 on a computer, on this one."""

import os
import pwd
import socket
from pathlib import Path

import pytest

from ur.robot.ros2 import finder

VARIABLES = ["ROS_DOMAIN_ID", "RMW_IMPLEMENTATION"]


def test_listening_ports_are_found() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        assert server.getsockname()[1] in finder.find_ports()


def test_processes_tell_their_user_and_variables() -> None:
    own = str(os.getpid())
    assert finder.owner(own) == pwd.getpwuid(os.getuid()).pw_name
    assert (finder.read_environment(own) or {})["PATH"]
    assert finder.owner("0") == ""
    assert finder.read_environment("0") is None


def test_lines_of_shell_files_that_set_a_variable_are_found(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("export ROS_DOMAIN_ID=7\n  RMW_IMPLEMENTATION=x\n# ROS_DOMAIN_ID=8\n")
    files = [str(tmp_path / "a"), str(tmp_path / "none")]
    assert finder.find_settings(files, VARIABLES) == [[files[0], "RMW_IMPLEMENTATION"], [files[0], "ROS_DOMAIN_ID"]]


def test_settings_files_of_middlewares_are_looked_for(tmp_path: Path) -> None:
    (tmp_path / "there.xml").touch()
    environments = [
        {"CYCLONEDDS_URI": f"file://{tmp_path}/there.xml"},
        {"CYCLONEDDS_URI": "<CycloneDDS/>", "FASTRTPS_DEFAULT_PROFILES_FILE": f"{tmp_path}/none.xml"},
    ]
    assert finder.find_files(environments) == {f"{tmp_path}/there.xml": True, f"{tmp_path}/none.xml": False}


def test_variables_of_a_new_terminal_are_read() -> None:
    assert set(finder.read_shell(VARIABLES)) <= set(VARIABLES)
    assert finder.find_unit("0") == ""
    assert finder.read_unit_environment("") is None
    assert finder.run(["/nowhere/program"], 1) == ""


def test_users_whose_units_lose_their_shared_memory_are_found(tmp_path: Path) -> None:
    user = pwd.getpwuid(os.getuid()).pw_name
    assert finder.find_forgotten([{"user": "root", "unit": "base.service"}], str(tmp_path)) == []
    units = [{"user": user, "unit": "base.service"}]
    assert finder.find_forgotten(units, str(tmp_path), 0) == [user]
    assert finder.find_forgotten([{"user": user, "unit": ""}, {"user": "no one", "unit": "a"}], str(tmp_path), 0) == []
    (tmp_path / "etc/systemd/logind.conf.d").mkdir(parents=True)
    (tmp_path / "etc/systemd/logind.conf").write_text("[Login]\nRemoveIPC=no\n")
    assert finder.find_forgotten(units, str(tmp_path), 0) == []
    (tmp_path / "etc/systemd/logind.conf.d/own.conf").write_text("[Login]\nRemoveIPC=yes\n")
    assert finder.find_forgotten(units, str(tmp_path), 0) == [user]
    (tmp_path / "var/lib/systemd/linger").mkdir(parents=True)
    (tmp_path / "var/lib/systemd/linger" / user).touch()
    assert finder.find_forgotten(units, str(tmp_path), 0) == []


def test_process_whose_own_shared_memory_was_removed_is_found() -> None:
    path = Path(f"/dev/shm/fastrtps_test{os.getpid()}_el")
    with path.open("w"):
        assert not finder.lost_memory(str(os.getpid()))
        path.unlink()
        assert finder.lost_memory(str(os.getpid()))
    assert not finder.lost_memory(str(os.getpid()))


def test_graph_is_read_without_modules_of_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "json.py").write_text("raise SystemExit('imported from the current folder')")
    argv = f"{os.path.realpath('/usr/bin/python3')} node"
    environment = {"PYTHONPATH": ":.:/opt/more"}
    leader = {"argv": argv, "variables": {}, "readable": True, "environment": environment, "distro": ""}
    request = {
        "graph": "import json, sys; print(json.dumps([each for each in sys.path if each in ('', '.', '/opt/more')]))",
        "variables": VARIABLES,
        "environment": {},
    }
    monkeypatch.chdir(tmp_path)
    assert finder.read_graph(request, [], [leader], {}) == (["/opt/more"], "")
    failing = {**request, "graph": "raise SystemExit('no rclpy')"}
    assert finder.read_graph(failing, [], [leader], {}) == (None, "no rclpy")
    assert finder.read_graph(request, [], [], {}) == (None, "no Python with rclpy was found")
