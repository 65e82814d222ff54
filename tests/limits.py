"""Run a command within a limit of processor time, and measure its memory."""

import os
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

# The memory of a process counts from before its exec on, so a small process has to start it, not this one.
_MEASURE = """
import os, resource, subprocess, sys
resource.setrlimit(resource.RLIMIT_CPU, (int(sys.argv[2]), int(sys.argv[2])))
process = subprocess.Popen(sys.argv[3:])
_, status, usage = os.wait4(process.pid, 0)
os.write(int(sys.argv[1]), f"{os.waitstatus_to_exitcode(status)} {usage.ru_maxrss}".encode())
"""


@dataclass(frozen=True)
class Used:
    """The exit code of a command, negative for a signal, its output and errors, and its peak memory in kB."""

    code: int
    output: str
    memory: int


def run_limited(command: list[str], cpu_seconds: int, folder: Path, environment: Mapping[str, str]) -> Used:
    """Run a command in a folder; the kernel kills it after `cpu_seconds` of processor time."""
    reader, writer = os.pipe()
    with os.fdopen(reader) as measured:
        try:
            done = subprocess.run(
                [sys.executable, "-I", "-S", "-c", _MEASURE, str(writer), str(cpu_seconds), *command],
                cwd=folder,
                env=dict(environment),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                pass_fds=[writer],
                check=True,
            )
        finally:
            os.close(writer)
        code, memory = measured.read().split()
    return Used(int(code), done.stdout, int(memory))
