"""Packages of npm for tests, with the computer's own settings, in `.cache`; nothing of them is committed."""

import fcntl
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

CACHE = Path(__file__).parents[1] / ".cache/npm"
PAGE = CACHE / "page"  # the tools of the page, which tools/set_up.bash installs from the lock of requirements/npm
OPTIONS = ("--no-save", "--no-audit", "--no-fund", "--ignore-scripts")


@contextmanager
def installed(name: str, packages: Sequence[str]) -> Iterator[Path]:
    """The folder `name` of the cache with these packages, installed once; other tests wait until the block ends.

    Skips the test where npm is missing or cannot install them.
    """
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("npm is not installed: sudo apt-get install npm")
    folder = CACHE / name
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "node_modules/.package-lock.json").exists():
            command = [npm, "install", *OPTIONS, "--prefix", str(folder), *packages]
            done = subprocess.run(command, capture_output=True, text=True, timeout=240, cwd=folder, check=False)
            if done.returncode:
                pytest.skip(f"npm cannot install {' and '.join(packages)}: {done.stderr.strip()[-200:]}")
        yield folder
