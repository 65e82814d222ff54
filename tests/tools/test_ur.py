"""The script `ur`: what it refuses before it sets anything up."""

from __future__ import annotations

import os
import shutil
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
