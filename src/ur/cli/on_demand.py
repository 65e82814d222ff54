"""Python packages that only some verbs need, installed when one of those is used first."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec

from ur.cli.environment import REPOSITORY
from ur.source.diagnostic import UserError, error


def need(module: str, lock: str) -> None:
    """Make sure that a module is there: install the lock file that holds it. Raises UserError when that fails."""
    if find_spec(module):
        return
    path = REPOSITORY / "requirements" / lock
    sys.stderr.write(f"installing what {path.name} holds, once ...\n")
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--require-hashes"]
    done = subprocess.run(
        [*command, "--only-binary", ":all:", "-r", str(path)], capture_output=True, text=True, check=False
    )
    if done.returncode:
        said = (done.stderr.strip().splitlines() or ["pip said nothing"])[-1]
        raise UserError(
            error(
                f"{module} could not be installed: {said}",
                rule="no-package",
                help="check the network and pip's settings (pip config list), then run this again",
            )
        )
