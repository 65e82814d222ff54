"""Commands of `ur` for an assistant: confined to packages and names, two at once, and within limits.

`run_command` is the only place where a text of an assistant becomes an argument of a program.
"""

import asyncio
import contextlib
import fcntl
import os
import re
import signal
import sys
from collections.abc import Collection, Iterator, Sequence

from ur.mcp.grants import grant_files
from ur.source.arguments import parse_argument
from ur.source.printable import printable
from ur.source.project import project_folder

_LIMIT = 60.0  # s
_LONGEST = 60_000  # characters
_MOST_BYTES = 4 * _LONGEST
_AT_ONCE = 2  # commands of all assistants of a user
_LIMITS = ("nice", "-n", "10", "prlimit", f"--as={1 << 30}", f"--cpu={_LIMIT:.0f}", "--core=0", "--")
_NAME = re.compile(r"[\w./][\w./@+-]*", re.ASCII)
_VALUE = re.compile(r"(?!\.\.?$)[\w.,:+ -]*", re.ASCII)


class RefusedCommandError(ValueError):
    """A command that is not run; the message is the reason, in one line."""


async def run_command(
    verb: Sequence[str],
    names: Sequence[str] = (),
    limit: float = _LIMIT,
    good: Collection[int] = (0, 1),
    *,
    limited: bool = True,
) -> tuple[bool, str]:
    """Run `ur` with a verb and its options, and the `names` that an assistant has given.

    Return whether it has ended with a `good` exit code, and its output. Exit code 1 is that of a command that has
    findings. `limited` is for commands that only read: programs would inherit the limits of memory and time. Raises
    RefusedCommandError.
    """
    for name in names:
        check_word(name)
    with _take_slot():
        return await _run((*verb, *names), limit, good, _LIMITS if limited else ())


def check_word(word: str) -> None:
    """Raise RefusedCommandError unless an assistant may give this word to a command: a package, a name, or NAME:=VALUE.

    A file or folder is one below a workspace or this project; a value is no path.
    """
    given = parse_argument(word)
    name = word if given is None else given.name
    shown = repr(printable(word)[:40])
    if not _NAME.fullmatch(name) or (given is not None and not _VALUE.fullmatch(given.value)):
        raise RefusedCommandError(f"{shown}, expected a package, a name, or NAME:=VALUE in which VALUE is no path")
    folder = str(project_folder())
    path = os.path.realpath(os.path.join(folder, name))  # noqa: PTH118 - exact paths
    if os.path.lexists(path) and not any(os.path.commonpath((path, top)) == top for top in _workspaces(folder)):
        raise RefusedCommandError(f"{shown} is outside of your user's workspaces, expected a package or a name")


def _workspaces(folder: str) -> list[str]:
    paths = [os.environ.get(each, "").split(os.pathsep) for each in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")]
    return [os.path.realpath(each) for each in (folder, *paths[0], *paths[1]) if each.startswith("/")]


@contextlib.contextmanager
def _take_slot() -> Iterator[None]:
    """Hold the lock of one of the commands that may run at once. Raises RefusedCommandError where all are held."""
    folder = grant_files().folder
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    for number in range(_AT_ONCE):
        with (folder / f"command_{number}.lock").open("a") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield
            return
    raise RefusedCommandError(f"{_AT_ONCE} commands of assistants run already; call again when one has ended")


async def _run(words: Sequence[str], limit: float, good: Collection[int], limits: Sequence[str]) -> tuple[bool, str]:
    process = await asyncio.create_subprocess_exec(
        *(*limits, sys.executable, "-I", "-m", "ur", *words),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        env={**os.environ, "NO_COLOR": "1", "COLUMNS": "120"},
        cwd=project_folder(),
        start_new_session=True,
    )
    assert process.stdout is not None
    try:
        out = await asyncio.wait_for(_read(process.stdout), limit)
        code = await process.wait()
    except asyncio.TimeoutError:
        return False, f"'ur {words[0]}' took longer than {limit:g} s and was ended"
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    text = out.decode("utf-8", "replace")
    cut = "\n... the rest is left out" if len(text) > _LONGEST else ""
    return code in good, text[:_LONGEST] + cut


async def _read(stream: asyncio.StreamReader) -> bytes:
    """Read to the end, and keep the beginning."""
    kept = b""
    while block := await stream.read(65536):
        kept += block[: _MOST_BYTES - len(kept)]
    return kept
