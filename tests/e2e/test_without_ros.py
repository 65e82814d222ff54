"""The first drive without ROS: all nodes in one process."""

import os
import subprocess
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT

pytestmark = pytest.mark.timeout(600)


def test_robot_is_driven_to_a_goal_by_nodes_in_one_process(tmp_path: Path) -> None:
    """The same program and arguments as with ROS; the exit code is that of the program, and nothing is left."""
    (tmp_path / "run").mkdir(mode=0o700)
    environment = {
        "HOME": str(tmp_path),
        "PATH": os.environ["PATH"],
        "UR_ROBOT": "sim:stage --ros none",
        "XDG_RUNTIME_DIR": str(tmp_path / "run"),
    }
    done = subprocess.run(
        [ROOT / "ur", "run", "keyboard_navigate"],
        env=environment,
        input="g 0.5 0 0\ng 0 100\n",
        capture_output=True,
        text=True,
        timeout=150,
        check=False,
    )
    reached, outside = done.stdout.splitlines()
    assert reached.startswith("g 0.5 0 0: reached, "), done
    assert "outside the map" in outside
    assert "all nodes are in one process, out of reach of other programs" in done.stderr
    assert done.returncode == 1
    logs = "".join(file.read_text() for file in (tmp_path / ".ros/log").rglob("*.log"))
    assert "[/move_base]: goal reached" in logs
    assert "[/simulator]: ended, exit code 0" in logs
    assert not list((tmp_path / "run/ubiquity_launches").glob("*.sock"))
