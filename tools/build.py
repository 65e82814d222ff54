"""Build the sdist and the wheel of this clone: build.py FOLDER. Prints the two paths.

The sdist is built from the files that git knows, as they are now, and the wheel from the unpacked sdist, so that a file
which either lacks is found here. The same commit gives the same wheel, byte by byte: its times are that of the commit.
Nothing is fetched: setuptools is that of the running Python.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_BUILD = (
    "import sys; from setuptools import build_meta; print(getattr(build_meta, 'build_' + sys.argv[1])(sys.argv[2]))"
)


def build(folder: Path, root: Path = ROOT) -> tuple[Path, Path]:
    """Build the sdist and the wheel of the clone `root` into a folder. Raises CalledProcessError."""
    folder = folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    epoch = _git(root, "log", "-1", "--format=%ct").strip()
    with tempfile.TemporaryDirectory(prefix="ur-build-") as name:
        clean = Path(name) / "clean"
        for each in filter(None, _git(root, "ls-files", "-z").split("\0")):
            if (root / each).is_symlink() or (root / each).is_file():  # not one that was removed
                (clean / each).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(root / each, clean / each, follow_symlinks=False)
        sdist = _run("sdist", folder, clean, epoch)
        shutil.unpack_archive(sdist, name)
        wheel = _run("wheel", folder, Path(name) / sdist.name.removesuffix(".tar.gz"), epoch)
    return sdist, wheel


def _run(kind: str, folder: Path, source: Path, epoch: str) -> Path:
    environment = {**os.environ, "SOURCE_DATE_EPOCH": epoch}
    command = [sys.executable, "-I", "-W", "ignore", "-c", _BUILD, kind, str(folder)]
    done = subprocess.run(command, cwd=source, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.stderr.write(done.stdout + done.stderr)
        done.check_returncode()
    return folder / done.stdout.splitlines()[-1]


def _git(root: Path, *arguments: str) -> str:
    done = subprocess.run(["git", "-C", str(root), *arguments], check=True, capture_output=True, text=True)
    return done.stdout


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"error: {len(sys.argv) - 1} arguments, expected one: the folder to build into")
    for path in build(Path(sys.argv[1])):
        print(path)
