"""Reports of unexpected exceptions: the traceback goes to a file, one line of text to the user."""

from __future__ import annotations

import os
import platform
import tempfile
import traceback
from collections.abc import Sequence
from pathlib import Path

from ur.source.printable import printable

EXIT_CODE = 70
"""Exit code of a program that an unexpected exception ended (EX_SOFTWARE of sysexits.h)."""

_LONGEST_REASON = 200


def write_crash_report(problem: BaseException, program: str, folders: Sequence[Path]) -> Path | None:
    """Write the traceback to a new file in the first folder that takes it, at last in the temporary folder.

    Return the file; None when no folder can be written to. Never raises.
    """
    text = f"{program}\nPython {platform.python_version()}, {platform.platform()}\n\n"
    text += "".join(traceback.format_exception(problem))
    for folder in (*folders, Path(tempfile.gettempdir())):
        path = folder / f"{program}-crash-{os.getpid()}.log"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            path.unlink(missing_ok=True)
            with path.open("x", encoding="utf-8", errors="replace") as file:  # never through somebody's symbolic link
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
