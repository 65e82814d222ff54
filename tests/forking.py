"""Programs in Python that tests start often: one interpreter imports their modules, and forks for each run."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

SERVER = Path(__file__).with_name("forking_server.py")


class ForkingPython:
    """Runs programs one after the other, as `subprocess.run` does, without the start of an interpreter for each.

    A program gets its own arguments, environment, folder and streams. What its modules read from the environment when
    they are imported they have read before.
    """

    def __init__(self, folder: Path, *command: str, modules: Sequence[str]) -> None:
        """`command` starts Python; `folder` is for the streams."""
        self._streams = [folder / name for name in ("stdin", "stdout", "stderr")]
        self._server = subprocess.Popen(
            [*command, str(SERVER), *modules], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def run(
        self, program: str, *arguments: str, folder: Path, environment: Mapping[str, str], given: bytes = b""
    ) -> subprocess.CompletedProcess[bytes]:
        """Run a file, or a module by its name, to its end; `given` is its standard input."""
        assert self._server.stdin
        assert self._server.stdout
        for stream in self._streams:
            stream.write_bytes(given if stream.name == "stdin" else b"")
        request = {
            "program": program,
            "arguments": arguments,
            "environment": dict(environment),
            "folder": str(folder),
            "streams": [str(each) for each in self._streams],
        }
        self._server.stdin.write(json.dumps(request) + "\n")
        self._server.stdin.flush()
        answer = self._server.stdout.readline()
        assert answer, f"{program} {' '.join(arguments)}: the interpreter that forks has ended"
        _, output, errors = (each.read_bytes() for each in self._streams)
        return subprocess.CompletedProcess([program, *arguments], int(answer), output, errors)

    def close(self) -> None:
        """End the interpreter."""
        self._server.communicate()
