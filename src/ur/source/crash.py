"""Reports of unexpected exceptions: the traceback goes to a file, one line of text to the user."""

import os
import platform
import tempfile
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

from ur.source.printable import printable

EXIT_CODE = 70
"""Exit code of a program that an unexpected exception ended (EX_SOFTWARE of sysexits.h)."""

_LONGEST_REASON = 200


def write_crash_report(
    problem: BaseException,
    program: str,
    folders: Sequence[Path],
    arguments: Sequence[str] = (),
    *,
    shared: Path | None = None,
    random: Callable[[int], bytes] = os.urandom,
) -> Path | None:
    """Write the traceback to a new file in the first writable folder, at last `shared` or the temporary folder.

    Only the user can read the file. Returns its path, or None if no folder is writable. Never raises.
    """
    text = f"{' '.join((program, *arguments))}\nPython {platform.python_version()}, {platform.platform()}\n\n"
    text += "".join(traceback.format_exception(problem))
    for folder in (*folders, shared or Path(tempfile.gettempdir())):
        path = folder / f"{program}-crash-{os.getpid()}-{random(2).hex()}.log"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Exclusive: in a shared folder another user may have created a link of this name.
            descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with open(descriptor, "w", encoding="utf-8", errors="backslashreplace") as file:  # noqa: PTH123
                file.write(text)
        except OSError:
            continue
        return path
    return None


def describe_crash(problem: BaseException, program: str, report: Path | None) -> str:
    """Describe an unexpected exception in one line that ends with the file to report."""
    reason = " ".join(printable(f"{type(problem).__name__}: {problem}").split()).removesuffix(":")
    if len(reason) > _LONGEST_REASON:
        reason = reason[: _LONGEST_REASON - 3] + "..."
    where = f" with the file {report}" if report else ""
    return f"error: internal error in '{program}': {reason}; please report it{where}"
