"""The audit of the locks installs its own tool from a lock, with hashes, and reports each lock in a line."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "tools" / "audit_locks.bash"
# Stands in for `python3 -m venv`: an environment whose pip writes down what it is asked.
PYTHON = """#!/bin/sh
mkdir -p .cache/audit/bin
printf '#!/bin/sh\\necho "$@" >>pip.asked\\n' >.cache/audit/bin/python
printf '#!/bin/sh\\ncase "$*" in *bad.lock*) echo Found 1 known vulnerability; exit 1;; esac\\n' \
  >.cache/audit/bin/pip-audit
chmod +x .cache/audit/bin/*
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    for folder in ("tools", "requirements", "stubs"):
        (tmp_path / folder).mkdir()
    shutil.copy(SCRIPT, tmp_path / "tools")
    for name in ("audit", "run"):
        (tmp_path / "requirements" / f"{name}.lock").touch()
    (tmp_path / "stubs" / "python3").write_text(PYTHON)
    (tmp_path / "stubs" / "python3").chmod(0o755)
    return tmp_path


def audit(project: Path) -> subprocess.CompletedProcess[str]:
    path = f"{project / 'stubs'}:{os.environ['PATH']}"
    command = ["bash", str(project / "tools" / SCRIPT.name)]
    return subprocess.run(command, env={"PATH": path}, capture_output=True, text=True, check=False)


def test_tool_is_installed_by_the_hashes_of_its_lock_and_again_when_that_changes(project: Path) -> None:
    assert audit(project).returncode == 0
    asked = (project / "pip.asked").read_text().splitlines()
    assert len(asked) == 1
    assert "--require-hashes --no-deps -r requirements/audit.lock" in asked[0]
    audit(project)
    assert (project / "pip.asked").read_text().splitlines() == asked
    later = (project / ".cache/audit/bin/pip-audit").stat().st_mtime + 10
    os.utime(project / "requirements" / "audit.lock", (later, later))
    audit(project)
    assert len((project / "pip.asked").read_text().splitlines()) == 2


def test_every_lock_is_audited_and_a_vulnerability_is_exit_code_one(project: Path) -> None:
    (project / "requirements" / "bad.lock").touch()
    done = audit(project)
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        "requirements/audit.lock: no known vulnerabilities",
        "requirements/bad.lock: Found 1 known vulnerability",
        "requirements/run.lock: no known vulnerabilities",
    ]
