"""Paths to which a sync is limited, and the lock of a sync."""

import fcntl
import getpass
import os
import socket
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from ur.source.diagnostic import UserError, error


def workspace_path(path: str, root: Path) -> str:
    """Return a PATH relative to the workspace, '' for all of it.

    A relative path begins at the current folder if that lies in the workspace.
    """
    real = root.resolve()
    here = Path.cwd()
    base = here if here.is_relative_to(real) else real
    whole = Path(os.path.normpath(base / Path(path).expanduser()))
    for top in (real, root):
        if whole.is_relative_to(top):
            relative = str(whole.relative_to(top))
            return "" if relative == "." else relative
    raise refuse_sync(f"{path} is not in {root}", "name paths of the workspace")


def check_paths(paths: Mapping[str, str], known: Collection[str], root: Path, robot: str) -> None:
    """Raise UserError for a path, as the user typed it, that exists on neither computer."""
    for typed, path in paths.items():
        if path and path not in known and not any(each.startswith(f"{path}/") for each in known):
            raise refuse_sync(f"{typed}: nothing of this name is in {root}, here or on {robot}", "ur sync --dry-run")


def name_this_computer(robot: str) -> str:
    """Return the name under which this computer keeps files that a sync with a robot replaces."""
    # One folder per robot, since several may be synced at once.
    return f"{socket.gethostname().split('.')[0]}-{getpass.getuser()}-{robot}"


@contextmanager
def lock_sync(path: Path) -> Iterator[None]:
    """Lock out a second sync with the same robot from this computer. Raises UserError."""
    place = path.with_suffix(".lock")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        lock = place.open("w")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise refuse_sync(f"{place}: {reason}", "fix that and run this again") from None
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise refuse_sync("another sync with this robot is running", "wait for it, then run this again") from None
        yield


def refuse_sync(message: str, help: str) -> UserError:
    """Return the error of a sync that cannot be done."""
    return UserError(error(message, rule="no-sync", help=help))
