"""Python packages that only some verbs and programs need, installed when one of those is first used."""

from __future__ import annotations

import fcntl
import importlib
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from ur.source.diagnostic import UserError, user_error
from ur.source.progress_line import show_progress
from ur.source.project import project_folder, state_folder

if TYPE_CHECKING:
    from subprocess import Popen

_PROBLEM = ("ERROR", "E: ")  # of pip, of apt-get
_NO_ROOM = ("No space left", "enough free space")
_STEMS = {"install": "install", "remove": "remov"}


class DiskFullError(UserError):
    """An installation that failed because the disk is full, so that another attempt would fail as well."""


def need_all(
    modules: Sequence[str], lock: str, title: str, *, folder: Path | None = None, pip: Sequence[str] = ()
) -> None:
    """Ensure that modules are installed: install the lock file that contains them. Raises UserError if that fails.

    `title` describes the installation for the user. Simultaneous installations wait for each other. A terminal shows
    the progress. `pip` is the command to install with, pip of the running Python unless given; `folder`, a clone of
    this project other than the one that runs.
    """
    if all(map(find_spec, modules)):
        return
    with _turn((folder or state_folder()) / ".cache" / "on_demand.lock"):
        importlib.invalidate_caches()  # the previous holder of the lock may have installed it
        missing = [module for module in modules if find_spec(module) is None]
        if missing:
            path = (folder or project_folder()) / "requirements" / lock
            sys.stderr.write(f"installing {title}, once ...\n")
            command = [*(pip or (sys.executable, "-I", "-m", "pip")), *_words(path)]
            run_installer(command, " and ".join(missing), "pip's settings (pip config list)")
            importlib.invalidate_caches()


def _words(path: Path) -> list[str]:
    return [
        *("install", "--disable-pip-version-check", "--progress-bar", "off", "--require-hashes"),
        *("--only-binary", ":all:", "-r", str(path)),
    ]


def run_installer(
    command: Sequence[str],
    missing: str,
    settings: str,
    verb: str = "install",
    show: Callable[[str], AbstractContextManager[Callable[[str], None]]] = show_progress,
    end: Callable[[Popen[str]], None] | None = None,
) -> None:
    """Run pip or apt-get, with its progress on a terminal. Raises UserError if it fails, DiskFullError for a full disk.

    `missing` are the packages that it installs, or with `verb` "remove" removes; `settings` names the place of settings
    that may cause a failure. `show` shows lines of progress, `end` ends the process.
    """
    import subprocess  # only for an installation

    help_ = f"check the network and {settings}, then run this again"
    began = time.monotonic()
    try:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
    except OSError as problem:
        raise _failure(missing, str(problem), help_, verb) from None
    reported: list[str] = []
    assert process.stdout is not None
    with process, show(f"{_STEMS[verb]}ing {missing}") as progress:
        try:
            for line in filter(None, map(str.strip, process.stdout)):
                reported.append(line)
                progress(line)
        except KeyboardInterrupt:
            with suppress(PermissionError):  # it is root's: Ctrl-C on a terminal has reached it, too
                (end or type(process).terminate)(process)
            raise
    if process.returncode:
        problems = [line for line in reported if line.startswith(_PROBLEM)]
        reason = (problems or reported or [f"exit code {process.returncode} of {command[0]}"])[-1]
        if any(text in reason for text in _NO_ROOM):
            help_ = "make room on the disk (df -h shows where there is none), then run this again"
            raise DiskFullError(*_failure(missing, _plain(reason), help_, verb).diagnostics)
        raise _failure(missing, _plain(reason), help_, verb)
    sys.stderr.write(f"{_STEMS[verb]}ed in {time.monotonic() - began:.0f} s\n")


def _plain(reason: str) -> str:
    return reason.removeprefix("ERROR: ").removeprefix("E: ")


def _failure(missing: str, reason: str, help_: str, verb: str) -> UserError:
    return user_error(
        f"{missing} could not be {_STEMS[verb]}ed: {reason}", rule="no-package", help=help_, subject=missing
    )


@contextmanager
def _turn(path: Path) -> Iterator[None]:
    """Hold an exclusive lock while the context lasts. Raises UserError if the file cannot be written."""
    try:
        path.parent.mkdir(exist_ok=True)
        file = path.open("w")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"{path}: {reason}, expected a copy of this project that is yours to write to"
        raise user_error(message, rule="no-package", help="git clone it into your home folder") from None
    with file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
