"""The guard's script alone, with a host that is a shell."""

import ctypes
import os
import shlex
import subprocess
import time
from pathlib import Path

import psutil
import pytest

from ur.run.host.guard import ALL_ENDED, SCRIPT

SUBREAPER = 36  # PR_SET_CHILD_SUBREAPER of linux/prctl.h
DAEMONS = "(setsid sleep 600 &); (setsid sh -c 'trap \"\" INT TERM; setsid sleep 600 & wait' &);"


def start_guard(folder: Path, host: str) -> tuple[subprocess.Popen[bytes], int]:
    """A guard with a host that runs this command; the guard's end of a pipe that both hold."""
    reader, writer = os.pipe()
    words = f"sh -c {shlex.quote(host)} <&- & exec /bin/sh {SCRIPT} ''"
    guard = subprocess.Popen(
        ["/bin/sh", "-c", words],
        stdin=reader,
        cwd=folder,
        preexec_fn=lambda: ctypes.CDLL(None).prctl(SUBREAPER, 1, 0, 0, 0),  # which exec keeps
    )
    os.close(reader)
    return guard, writer


def find_sleepers(folder: Path) -> list[psutil.Process]:
    every = psutil.process_iter(["name", "cwd"])
    return [each for each in every if each.info["name"] == "sleep" and each.info["cwd"] == str(folder)]


def await_sleepers(folder: Path, count: int) -> None:
    end = time.monotonic() + 60
    while len(find_sleepers(folder)) != count:
        assert time.monotonic() < end
        time.sleep(0.02)


def test_guard_of_a_host_that_was_killed_ends_every_generation(tmp_path: Path) -> None:
    guard, writer = start_guard(tmp_path, f"{DAEMONS} exec sleep 600")
    await_sleepers(tmp_path, 3)
    os.close(writer)
    assert guard.wait(60) == 0
    assert find_sleepers(tmp_path) == []


def test_guard_believes_a_host_that_has_ended_all(tmp_path: Path) -> None:
    guard, writer = start_guard(tmp_path, "exec sleep 600")
    await_sleepers(tmp_path, 1)
    os.write(writer, ALL_ENDED)
    assert guard.wait(60) == 0
    [left] = find_sleepers(tmp_path)
    left.kill()
    os.close(writer)


def test_guard_lets_drivers_of_motors_end_by_themselves(tmp_path: Path) -> None:
    finish = "printf ur-motor-driver >/proc/$$/comm; touch ready; read -r _ <ended; touch at_rest"
    guard, writer = start_guard(tmp_path, f"mkfifo ended; (setsid sh -c '{finish}' &); exec sleep 600")
    end = time.monotonic() + 60
    while not (tmp_path / "ready").exists():
        assert time.monotonic() < end
        time.sleep(0.02)
    await_sleepers(tmp_path, 1)
    [host] = find_sleepers(tmp_path)
    os.close(writer)
    host.wait(60)
    (tmp_path / "ended").write_text("\n")
    assert guard.wait(60) == 0
    assert (tmp_path / "at_rest").exists()


@pytest.mark.parametrize("word", [b"", b"nonsense\n"])
def test_guard_without_anything_left_just_ends(tmp_path: Path, word: bytes) -> None:
    guard, writer = start_guard(tmp_path, "exit 0")
    os.write(writer, word)
    os.close(writer)
    assert guard.wait(60) == 0
