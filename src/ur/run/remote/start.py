"""Start of a robot's share of a run, detached from the connection that requested it."""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from ur.run.remote.local_runs import share_arguments
from ur.run.remote.protocol import Problem, ShareRequest
from ur.source.foreign.json_values import read_json

START_SECONDS = 60.0


def start_share(request: ShareRequest, running: Sequence[str]) -> tuple[str, Problem | None]:
    """Start the share without the nodes that are already running; return the id of its run, or the problem."""
    with (
        tempfile.TemporaryFile("w+") as out,
        tempfile.TemporaryFile("w+") as err,
        tempfile.TemporaryDirectory() as folder,
    ):
        # Files: processes that continue to run would keep a pipe open.
        report = Path(folder, "problems.json")
        process = subprocess.Popen(
            [*scope(), sys.executable, "-I", "-m", "ur", *launch_arguments(request, running, str(report))],
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=err,
        )
        try:
            code = process.wait(START_SECONDS)
        except subprocess.TimeoutExpired:
            process.terminate()
            return "", Problem(f"its nodes did not start within {START_SECONDS:g} s")
        out.seek(0)
        err.seek(0)
        if code:
            return "", read_report(report) or Problem(
                _last_line(err.read()) or f"ur launch ended with exit code {code}"
            )
        return out.read().strip(), None


def launch_arguments(request: ShareRequest, running: Sequence[str], report: str) -> list[str]:
    """Return the arguments of `ur` that start the share, without nodes that are already running."""
    left_out = [word for name in running for word in ("--runs-already", name)]
    return ["launch", "--plain", "--detach", "--report", report, *left_out, *share_arguments(request)]


def read_report(report: Path) -> Problem | None:
    """Return the first problem that `ur launch` has reported, or None."""
    try:
        return next(iter(read_json(report.read_text(encoding="utf-8"), list[Problem])), None)
    except (OSError, ValueError):
        return None


def scope() -> list[str]:
    """Return the command that runs a process under the user's service manager, if that survives logout; else empty.

    Without lingering the manager ends with the last session, and all of its services with it; background processes of a
    session do not.
    """
    if not shutil.which("systemd-run") or not Path(f"/run/user/{os.getuid()}/systemd/private").exists():
        return []
    asked = subprocess.run(
        ["loginctl", "show-user", "-P", "Linger", str(os.getuid())], capture_output=True, text=True, check=False
    )
    if asked.stdout.strip() != "yes":
        return []
    os.environ.setdefault("XDG_RUNTIME_DIR", f"/run/user/{os.getuid()}")
    return ["systemd-run", "--user", "--scope", "--quiet", "--collect"]


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else ""
