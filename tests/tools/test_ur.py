"""The script `ur`: what it refuses before it sets anything up."""

import contextlib
import os
import select
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can stand for sudo")
def test_sudo_in_a_folder_of_a_user_is_refused_before_the_set_up(tmp_path: Path) -> None:
    clone = tmp_path / "clone"
    (clone / "tools").mkdir(parents=True)
    (clone / "src/ur").mkdir(parents=True)
    shutil.copy(ROOT / "ur", clone / "ur")
    (clone / "tools/set_up.bash").write_text("mkdir .venv; echo set up; exit 3\n")
    environment = {"PATH": "/usr/bin:/bin", "SUDO_USER": "pat"}

    def run() -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [clone / "ur", "list"], cwd=clone, env=environment, capture_output=True, text=True, check=False
        )

    os.chown(clone, 65534, 65534)
    done = run()
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: {clone} belongs to another user")
    assert not (clone / ".venv").exists()
    os.chown(clone, 0, 0)
    assert run().stdout == "set up\n"  # root's own folder


def test_debian_root_is_found_with_another_home_and_made_again_when_it_is_gone(tmp_path: Path) -> None:
    clone, data = tmp_path / "clone", tmp_path / "home/debian-13"
    for folder in (clone / "src/ur/system", clone / "tools", clone / "requirements", clone / ".venv/bin", data):
        folder.mkdir(parents=True)
    shutil.copy(ROOT / "ur", clone / "ur")
    for name in ("tools/set_up.bash", "src/ur/system/ros_packages.txt", "requirements/run.lock", "pyproject.toml"):
        (clone / name).write_text("echo set up; exit 3\n")
    (clone / ".venv/bin/python").write_text("#!/bin/sh\necho it runs\n")
    (clone / ".venv/bin/python").chmod(0o755)
    (clone / ".venv/debian").write_text(f"{data}\n")
    (clone / ".venv/ready-run").write_text(f"{clone}\n")
    (data / "enter.bash").touch()
    command = [str(clone / "ur"), "list"]
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path / "another")}
    assert subprocess.check_output(command, env=environment, text=True) == "it runs\n"
    (data / "enter.bash").unlink()
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (3, "set up\n")


def test_ros2_on_arm64_is_refused_before_the_set_up_begins(tmp_path: Path) -> None:
    for name in ("tools", "src/ur/system"):
        shutil.copytree(ROOT / name, tmp_path / "clone" / name)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/uname").write_text("#!/bin/sh\necho aarch64\n")
    (tmp_path / "bin/uname").chmod(0o755)
    environment = {"PATH": f"{tmp_path}/bin:/usr/bin:/bin", "HOME": str(tmp_path)}
    command = ["bash", str(tmp_path / "clone/tools/set_up.bash"), "ros2"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-2] == "error: there is no ROS 2 as Python packages for aarch64"
    assert "setting up" not in done.stderr
    assert not (tmp_path / "clone/.venv").exists()


def make_clone(tmp_path: Path, cases: str) -> Path:
    """A clone that has an environment, whose Python answers pip and compileall by cases of bash."""
    clone = tmp_path / "clone"
    for name in ("tools", "requirements", "src/ur/system"):
        shutil.copytree(ROOT / name, clone / name)
    (clone / "pyproject.toml").touch()
    (clone / ".venv/bin").mkdir(parents=True)
    python = clone / ".venv/bin/python"
    python.write_text(f'#!/bin/bash\ncase "$*" in\n{cases}\n-c*) exec /usr/bin/python3 "$@" ;;\nesac\n')
    python.chmod(0o755)
    return clone


def test_set_up_without_a_network_says_so_in_one_line(tmp_path: Path) -> None:
    words = (
        "WARNING: Retrying: <x>: Failed to establish a new connection: [Errno -3] Temporary failure in name resolution"
    )
    clone = make_clone(tmp_path, f"*--require-hashes*) for i in 1 2 3; do echo '{words}'; done; exit 1 ;;")
    environment = {"PATH": os.environ["PATH"], "HOME": str(tmp_path)}
    command = ["bash", str(clone / "tools/set_up.bash"), "run"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    log = clone / ".cache/set_up.log"
    assert done.stderr.splitlines()[-3:] == [
        f"error: Python packages: no network: Temporary failure in name resolution (details in {log})",
        "error: the Python packages could not be installed",
        "  help: check the network and pip's settings (pip config list), then run this again",
    ]


def test_ctrl_c_in_the_set_up_ends_all_that_it_started_and_frees_the_lock(tmp_path: Path) -> None:
    ready = tmp_path / "ready"
    os.mkfifo(ready)
    # pip is content at once; compileall has a worker that outlives it
    clone = make_clone(tmp_path, f"*compileall*) (echo $BASHPID >{ready}; exec sleep 600) & wait ;;")
    command = ["bash", str(clone / "tools/set_up.bash"), "run"]
    environment = {"PATH": os.environ["PATH"], "HOME": str(tmp_path)}
    first = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True, start_new_session=True)
    worker = os.pidfd_open(int(ready.read_text()))
    second = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True, start_new_session=True)
    try:
        assert second.stderr is not None
        waits = f"another set-up of this folder is running, process {first.pid}: waiting for it\n"
        assert second.stderr.readline() == waits
        os.killpg(first.pid, signal.SIGINT)
        assert first.wait(20) == 130
        assert ready.read_text()  # the second one has the lock, and compiles
        assert select.select([worker], [], [], 20)[0]  # it has ended
        os.killpg(second.pid, signal.SIGINT)
        assert second.wait(20) == 130
    finally:
        os.close(worker)
        for each in (first, second):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(each.pid, signal.SIGKILL)
            each.communicate()
