"""The environment variables that the set-up file of an installed ROS 2 sets."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping

from ur.source.diagnostic import UserError, error_about

_LIMIT = 20.0  # s
_SCRIPT = 'unset AMENT_PREFIX_PATH; . "$1" >&2 && exec env -0'
_LEFT_OUT = ("_", "SHLVL", "PWD", "OLDPWD")


def source_ros(prefix: str, environment: Mapping[str, str]) -> dict[str, str]:
    """Run the set-up file of the ROS 2 in `prefix`; return the changes of `environment`. Raises UserError."""
    file = f"{prefix}/setup.bash"
    command = ["bash", "--norc", "-c", _SCRIPT, "bash", file]
    try:
        done = subprocess.run(command, env=environment, capture_output=True, timeout=_LIMIT, check=False)
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise UserError(error_about(file, f"cannot be run: {problem}", rule="bad-ros")) from None
    if done.returncode:
        reason = done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:] or ["it fails"]
        raise UserError(error_about(file, f"cannot be run: {reason[0]}", rule="bad-ros"))
    pairs = (each.partition("=") for each in done.stdout.decode("utf-8", "surrogateescape").split("\0") if each)
    return {name: value for name, _, value in pairs if name not in _LEFT_OUT and environment.get(name) != value}
