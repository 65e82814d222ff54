"""Python packages that only some verbs and programs need, installed when one of those is used first."""

from __future__ import annotations

import fcntl
import importlib
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TextIO

from ur.cli.environment import REPOSITORY
from ur.source.diagnostic import UserError, error

_WIDTH = 78
_PERIOD = 0.3  # s between lines of progress


def need(module: str, lock: str) -> None:
    """Make sure that a module is there: install the lock file that holds it. Raises UserError when that fails."""
    need_all([module], lock, f"what {lock} holds")


def need_all(
    modules: Sequence[str], lock: str, title: str, *, folder: Path = REPOSITORY, pip: Sequence[str] = ()
) -> None:
    """Make sure that modules are there: install the lock file that holds them. Raises UserError when that fails.

    `title` says what that is, for people. Two that want the same at once wait for one another. A terminal shows what
    goes on. `pip` is the command to install with, pip of the running Python unless given.
    """
    if all(map(find_spec, modules)):
        return
    with _turn(folder / ".cache" / "on_demand.lock"):
        importlib.invalidate_caches()  # whoever had the turn before may have installed it
        missing = [module for module in modules if find_spec(module) is None]
        if missing:
            path = folder / "requirements" / lock
            sys.stderr.write(f"installing {title}, once ...\n")
            _install([*(pip or (sys.executable, "-m", "pip")), *_words(path)], " and ".join(missing))
            importlib.invalidate_caches()


def _words(path: Path) -> list[str]:
    return [
        *("install", "--disable-pip-version-check", "--progress-bar", "off", "--require-hashes"),
        *("--only-binary", ":all:", "-r", str(path)),
    ]


def _install(command: Sequence[str], missing: str) -> None:
    began = time.monotonic()
    try:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
    except OSError as problem:
        raise _failure(missing, str(problem)) from None
    said: list[str] = []
    assert process.stdout is not None
    with process, _progress(sys.stderr, said, began):
        try:
            said.extend(filter(None, map(str.strip, process.stdout)))
        except KeyboardInterrupt:
            process.terminate()
            raise
    if process.returncode:
        problems = [line for line in said if line.startswith("ERROR")]
        raise _failure(missing, (problems or said or ["pip said nothing"])[-1].removeprefix("ERROR: "))
    sys.stderr.write(f"installed in {time.monotonic() - began:.0f} s\n")


def _failure(missing: str, reason: str) -> UserError:
    help_ = "check the network and pip's settings (pip config list), then run this again"
    return UserError(error(f"{missing} could not be installed: {reason}", rule="no-package", help=help_))


@contextmanager
def _progress(out: TextIO, said: Sequence[str], began: float) -> Iterator[None]:
    """On a terminal, one line that changes: the time, and what was said last."""
    if not out.isatty():
        yield
        return
    over = threading.Event()

    def show() -> None:
        while not over.wait(_PERIOD):
            line = f"  {time.monotonic() - began:.0f} s: {said[-1] if said else ''}"
            out.write(f"\r\x1b[K{line[:_WIDTH]}")
            out.flush()

    thread = threading.Thread(target=show, name="progress", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
        out.write("\r\x1b[K")
        out.flush()


@contextmanager
def _turn(path: Path) -> Iterator[None]:
    """Alone in this for as long as it takes. Raises UserError where the file cannot be written."""
    try:
        path.parent.mkdir(exist_ok=True)
        file = path.open("w")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"{path}: {reason}, expected a copy of this project that is yours to write to"
        raise UserError(error(message, rule="no-package", help="git clone it into your home folder")) from None
    with file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
