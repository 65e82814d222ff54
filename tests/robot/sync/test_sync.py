"""How files are carried: rsync over the connection that is open, beside the workspace."""

from typing import Any

import pytest

from ur.robot.ssh.address import Address
from ur.robot.ssh.openssh import SshShell
from ur.robot.sync.steps import File, check_path
from ur.robot.sync.sync import rsync_command
from ur.source.foreign.json_values import convert_json

ROOTS = {"here": "/home/pat/catkin_ws/src", "there": "/home/ros/catkin_ws/src"}
SSH = SshShell(Address("ros", "bob.local"), ["-o", "ControlPath=/run/a b"])


def test_open_connection_is_used_or_none() -> None:
    assert SSH.words[0] == "ssh"
    assert {"ProxyCommand=false", "ControlPath=/run/a b"} <= set(SSH.words)


def test_files_arrive_beside_the_workspace_and_build_on_what_is_there() -> None:
    words = rsync_command(SSH.words, "ros@bob.local", "there", ROOTS, "/home/ros/catkin_ws/.ur_sync/x", progress=False)
    assert words[-2:] == ["/home/pat/catkin_ws/src/", "ros@bob.local:/home/ros/catkin_ws/.ur_sync/x/"]
    assert "--copy-dest=/home/ros/catkin_ws/src" in words
    assert not {"--delete", "--inplace"} & set(words)
    assert "'ControlPath=/run/a b'" in words[words.index("-e") + 1]


def test_other_direction_turns_source_and_target() -> None:
    words = rsync_command(SSH.words, "ros@bob.local", "here", ROOTS, "/home/pat/catkin_ws/.ur_sync/x", progress=True)
    assert words[-2:] == ["ros@bob.local:/home/ros/catkin_ws/src/", "/home/pat/catkin_ws/.ur_sync/x/"]
    assert "--info=progress2" in words


@pytest.mark.parametrize("path", ["../x", "a/../../x", "/etc/x", "", "a//b", "./a", "a/", "a\0b", ".."])
def test_path_that_leads_out_of_the_workspace_is_refused(path: str) -> None:
    with pytest.raises(ValueError, match="no path inside of a workspace"):
        check_path(path)


@pytest.mark.parametrize(
    "row",
    [["device", 0, 0, False, ""], ["file", "1", 0, False, ""], ["file", 1, 0, 1, ""], ["file", 1, 0, False, 1], []],
)
def test_row_that_is_no_file_is_refused(row: list[Any]) -> None:
    with pytest.raises((ValueError, TypeError)):
        convert_json({"a": row}, dict[str, File])


def test_names_that_only_look_like_ways_out_are_files() -> None:
    assert [check_path(each) for each in ("a/..b", "...")] == ["a/..b", "..."]
