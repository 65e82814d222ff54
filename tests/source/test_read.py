"""Files that are none are refused: nothing waits, and nothing fills the memory."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from ur.source import UserError
from ur.source.read import read_source


def test_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "robot.yaml")
    with pytest.raises(UserError, match="not a regular file"):
        read_source(tmp_path / "robot.yaml")


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/full", "/dev/urandom"])
def test_link_to_an_endless_device_is_refused(tmp_path: Path, device: str) -> None:
    (tmp_path / "robot.yaml").symlink_to(device)
    with pytest.raises(UserError, match="not a regular file"):
        read_source(tmp_path / "robot.yaml")


def test_large_file_is_refused(tmp_path: Path) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.truncate(100 * 1024 * 1024)
    with pytest.raises(UserError, match="larger than"):
        read_source(tmp_path / "large")


def test_pipe_of_a_shell_is_read() -> None:
    reader, writer = os.pipe()
    os.write(writer, b"a: 1\r\n")
    os.close(writer)
    assert read_source(f"/dev/fd/{reader}").text == "a: 1\n"
    os.close(reader)


@pytest.mark.parametrize("name", ["CMakeLists.txt", "package.xml"])
@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_package_with_files_that_are_none_is_refused(tmp_path: Path, name: str, kind: str) -> None:
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / name).unlink(missing_ok=True)
    if kind == "pipe":
        os.mkfifo(tmp_path / name)
    else:
        (tmp_path / name).symlink_to("/dev/zero")
    words = [sys.executable, "-I", "-m", "ur", "check", "--package", str(tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert "internal error" not in done.stderr
