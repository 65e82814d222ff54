"""Commands of `ur` for an assistant: a process each, with limits of time and output, and without a terminal."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import sys
from collections.abc import Collection, Sequence

_LIMIT = 60.0  # s
_LONGEST = 60_000  # characters


async def run_command(words: Sequence[str], limit: float = _LIMIT, good: Collection[int] = (0, 1)) -> tuple[bool, str]:
    """Run `ur` with these arguments. Return whether it has ended with a `good` exit code, and its output.

    Exit code 1 is that of a command that has findings.
    """
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-I", "-m", "ur", *words),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        env={**os.environ, "NO_COLOR": "1", "COLUMNS": "120"},
        start_new_session=True,
    )
    try:
        out, _ = await asyncio.wait_for(process.communicate(), limit)
    except asyncio.TimeoutError:
        return False, f"'ur {words[0]}' took longer than {limit:g} s and was ended"
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    text = out.decode("utf-8", "replace")
    cut = f"\n... {len(text) - _LONGEST} characters are left out" if len(text) > _LONGEST else ""
    return process.returncode in good, text[:_LONGEST] + cut
