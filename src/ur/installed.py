"""The environment of an installed wheel: made on first use, since the one that pipx or uv has made sees nothing of ROS.

Nodes need the system's Python and its ROS packages beside the locked Python packages. So the first command that starts
something lets `tools/set_up.bash` make an environment in the user's data folder, with a copy of what the wheel holds,
and every later command runs there. The script `ur` takes the same decision without starting Python twice.
"""

import os
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from ur.mcp import NOT_INSTALLED
from ur.source.diagnostic import UserError
from ur.source.project import DISTRIBUTION, package_folder, project_folder, state_folder

READY = "ready-run"
_NO_VERBS = frozenset({"--version", "--help", "-h", "help"})


def enter_environment(arguments: Sequence[str]) -> int | None:
    """Continue in the environment of the user, which is made if need be; the exit code if that fails.

    Returns None where this process is to go on: it runs in that environment, or the command needs none.
    """
    state = state_folder()
    environment = state / ".venv"
    if os.path.realpath(sys.prefix) == os.path.realpath(environment) or not _needs_environment(arguments):
        return None
    if not is_current(environment, Path(sys.prefix)):
        if list(arguments) == ["mcp"]:  # the assistant's program would not wait
            sys.stderr.write(f"error: {NOT_INSTALLED.format('ur')}\n")
            return 2
        code = subprocess.run(["bash", str(project_folder() / "tools/set_up.bash"), "run", str(state)], check=False)
        if code.returncode:
            return code.returncode if code.returncode > 0 else 128 - code.returncode
    python = str(environment / "bin/python")
    return os.execv(python, [python, "-I", "-m", "ur", *arguments])  # noqa: S606 - a program, not a shell


def is_current(environment: Path, prefix: Path) -> bool:
    """Return whether an environment was made from the wheel installed in `prefix`, as it is now."""
    ready = environment / READY
    records = list(package_folder().parent.glob(f"{DISTRIBUTION.replace('-', '_')}-*.dist-info/RECORD"))
    if (environment / "debian").exists() and not (environment.parent / "debian-13/enter.bash").exists():
        return False  # `ur setup debian remove` has taken away what it runs in
    try:
        with ready.open(encoding="utf-8") as lines:
            made_from = lines.readline().rstrip("\n")
        return made_from == os.path.realpath(prefix) and all(
            each.stat().st_mtime <= ready.stat().st_mtime for each in records
        )
    except OSError:
        return False


def _needs_environment(arguments: Sequence[str]) -> bool:
    from ur.cli.verbs import VERBS

    if not arguments or arguments[0] in _NO_VERBS or (arguments[0] in VERBS and not VERBS[arguments[0]].needs_ros):
        return False
    if arguments[0] == "launch":
        from ur.cli.launch.launch import OF_FILES
        from ur.cli.launch.options import BadOptionError, read_launch

        with suppress(BadOptionError, UserError):
            asked = {name for name, _ in read_launch(arguments[1:])[1].queries}
            if asked and asked <= OF_FILES:
                return False
    end = 2 if arguments[0] == "run" else len(arguments)  # what follows a program is its own
    return not any(word in ("--help", "-h") for word in arguments[1:end])
