"""Commands in the Debian root and outside of it, for the trials of tests/fresh/brought.py. Needs only Python."""

import contextlib
import os
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

UR = str(Path(__file__).resolve().parents[2] / "ur")
INSIDE = [UR, "setup", "debian", "shell"]
NODES = 50
PATIENCE = 120.0


def run(*words: str, **changes: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, env={**os.environ, **changes}
    )


def inside(line: str, **changes: str) -> subprocess.CompletedProcess[str]:
    return run(*INSIDE, "bash", "-c", line, **changes)


def wait_for(condition: Callable[[], object], what: str, seconds: float = PATIENCE) -> float:
    began = time.monotonic()
    while not condition():
        assert time.monotonic() - began < seconds, f"{what}: not within {seconds:.0f} s"
        time.sleep(0.02)
    return time.monotonic() - began


def processes(mark: str) -> list[int]:
    """The processes whose command line has this mark."""
    found = []
    for each in Path("/proc").iterdir():
        with contextlib.suppress(OSError):
            if each.name.isdigit() and mark.encode() in (each / "cmdline").read_bytes():
                found.append(int(each.name))
    return [each for each in found if each != os.getpid()]


@contextlib.contextmanager
def launch_file(mark: str, nodes: int) -> Iterator[Path]:
    """A launch file whose nodes sleep, and a package with their program."""
    with tempfile.TemporaryDirectory(dir=Path.home()) as folder:
        package = Path(folder) / "fifty"
        package.mkdir()
        (package / "package.xml").write_text(
            "<package format='2'><name>fifty</name><version>0.1.0</version><description>d</description>"
            "<maintainer email='a@b.c'>a</maintainer><license>BSD</license></package>"
        )
        (package / "doze").write_text('#!/bin/bash\nexec -a "$1" sleep 1000\n')
        (package / "doze").chmod(0o755)
        lines = "".join(f'<node pkg="fifty" type="doze" name="n{i}" args="{mark}"/>' for i in range(nodes))
        (package / "fifty.launch").write_text(f"<launch>{lines}</launch>")
        os.environ["ROS_PACKAGE_PATH"] = str(package)
        yield package / "fifty.launch"
