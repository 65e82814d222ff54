"""`ur run PROGRAM --web`: a program and its page, which end together."""

import asyncio
import os
import signal
import sys
from collections.abc import Sequence
from contextlib import suppress

import click

from ur.request.environment import current_selection
from ur.request.requirements.python_packages import need_all
from ur.system.child_processes import end_with_us

_PATIENCE = 60.0  # s that the program gets to end


def run_with_page(program: str, words: Sequence[str], *, foxglove: bool = False) -> int:
    """Serve the page while a program runs with these arguments, and return the exit code of the program.

    Nodes that need the terminal are left out: the page replaces them. Ctrl-C ends both, and so does the end of the
    program. With `foxglove` an address for viewers is printed, too. Raises UserError if no port is free.
    """
    need_all(["aiohttp", "segno"], "web.lock", "what the page needs (2 MB to download)")
    if foxglove:
        need_all(["foxglove"], "foxglove.lock", "what Foxglove and Lichtblick need (20 MB to download)")
    from ur.web.server.serve import ServerOptions, serve

    selection = current_selection(os.environ)
    options = ServerOptions("simulated robot" if selection.simulated else selection.robot, foxglove=foxglove)

    async def run_both() -> int:
        process = await asyncio.create_subprocess_exec(
            *end_with_us(),
            *(sys.executable, "-I", "-m", "ur", "run", program, "--plain", "--no-terminal", *words),
            stdin=asyncio.subprocess.DEVNULL,
            start_new_session=True,  # Ctrl-C is for this process, which ends that one
        )
        try:
            await serve(options, click.echo, process.wait)
        finally:
            await _end(process)
        return process.returncode or 0

    return asyncio.run(run_both())


async def _end(process: asyncio.subprocess.Process) -> None:
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        if process.returncode is not None:
            return
        with suppress(ProcessLookupError):
            process.send_signal(number)
        with suppress(asyncio.TimeoutError):
            await asyncio.wait_for(process.wait(), _PATIENCE)
