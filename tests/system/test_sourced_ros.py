from pathlib import Path

import pytest

from ur.source.diagnostic import UserError
from ur.system.ros import source_ros


def test_variables_of_a_set_up_file_are_those_that_it_changes(tmp_path: Path) -> None:
    (tmp_path / "setup.bash").write_text('echo loud; export ROS_DISTRO=jazzy PATH="/opt/bin:$PATH" TEXT="two\nlines"\n')
    found = source_ros(str(tmp_path), {"PATH": "/usr/bin:/bin", "HOME": "/home/me"})
    assert found == {"ROS_DISTRO": "jazzy", "PATH": "/opt/bin:/usr/bin:/bin", "TEXT": "two\nlines"}


def test_set_up_file_that_fails_is_named_with_its_reason(tmp_path: Path) -> None:
    (tmp_path / "setup.bash").write_text("echo no such workspace >&2; return 3\n")
    with pytest.raises(UserError, match=r"setup\.bash: cannot be run: no such workspace"):
        source_ros(str(tmp_path), {"PATH": "/usr/bin:/bin"})


def test_set_up_file_without_a_shell_to_run_it_is_named(tmp_path: Path) -> None:
    (tmp_path / "setup.bash").touch()
    with pytest.raises(UserError, match=r"setup\.bash: cannot be run: .*No such file or directory: 'bash'"):
        source_ros(str(tmp_path), {"PATH": "/nowhere"})
