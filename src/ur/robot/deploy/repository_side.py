"""Program that updates a copy of this project in a folder of a robot: only files that differ, each atomically.

It is sent to the robot, where nothing of this project is installed yet: one file that uses only the standard library.
It reads JSON from standard input: `folder`, `digest`, and `files`, by path `[mode, content in base64]`; mode 0 is a
symbolic link, with its target as content. The copy stores the hashes of the files it wrote, last of all: a file that
was changed since is saved beside the folder before it is replaced.
"""

import base64
import hashlib
import json
import os
import sys
from pathlib import Path

STAMP = ".copy"
HASHES = ".copy-files"


def put(folder: Path, digest: str, files: dict[str, tuple[int, str]]) -> list[str]:
    """Update the folder; return the paths of files that were edited by hand and are now saved in FOLDER.changed.

    New content is on the disk before it replaces any file, and all of it before the copy counts as complete.
    """
    before = _load(folder / HASHES)
    after = {}
    wanted = []
    kept = []
    for path, (mode, text) in sorted(files.items()):
        content = base64.b64decode(text)
        after[path] = hashlib.sha256(content).hexdigest()
        target = folder / path
        now = _hash(target)
        if now == after[path] and (mode == 0 or target.stat().st_mode & 0o777 == mode):
            continue
        _prepare(target, content, mode)
        wanted.append((path, now))
    os.sync()  # one sync for all files: a robot's SD card is slow for each single one
    for path, now in wanted:
        if now is not None and now not in (before.get(path), after[path]):
            _keep(folder, path)
            kept.append(path)
        os.replace(_beside(folder / path), folder / path)  # noqa: PTH105 - it says that it replaces
    for path in sorted(before.keys() - after.keys()):
        if _hash(folder / path) == before[path]:
            (folder / path).unlink()
    _write(folder / HASHES, json.dumps(after).encode(), 0o644)
    _write(folder / STAMP, f"{digest}\n".encode(), 0o644)
    return kept


def _load(path: Path) -> dict[str, str]:
    try:
        return dict(json.loads(path.read_text()))
    except (OSError, ValueError, TypeError):
        return {}


def _hash(path: Path) -> str | None:
    try:
        content = os.fsencode(path.readlink()) if path.is_symlink() else path.read_bytes()
    except OSError:
        return None
    return hashlib.sha256(content).hexdigest()


def _keep(folder: Path, path: str) -> None:
    target = folder.with_name(f"{folder.name}.changed") / path
    target.parent.mkdir(parents=True, exist_ok=True)
    os.replace(folder / path, target)  # noqa: PTH105 - it says that it replaces


def _write(target: Path, content: bytes, mode: int) -> None:
    _prepare(target, content, mode)
    os.sync()
    os.replace(_beside(target), target)  # noqa: PTH105 - it says that it replaces
    os.sync()


def _beside(target: Path) -> Path:
    return target.with_name(f"{target.name}.new")


def _prepare(target: Path, content: bytes, mode: int) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    new = _beside(target)
    new.unlink(missing_ok=True)
    if mode == 0:
        new.symlink_to(os.fsdecode(content))
    else:
        new.write_bytes(content)
        new.chmod(mode)


def main() -> None:
    """Write the files of the request on standard input, and print each existing file that was kept."""
    request = json.load(sys.stdin)
    folder = Path(os.path.expanduser(request["folder"]))  # noqa: PTH111 - Path.expanduser raises where HOME is unset
    folder.mkdir(parents=True, exist_ok=True)
    # From here on the folder is a copy, not the user's own: the next run completes an interrupted one.
    if not (folder / STAMP).exists():
        _write(folder / STAMP, b"incomplete\n", 0o644)
    for path in put(folder, request["digest"], request["files"]):
        sys.stdout.write(f"kept {path}\n")


if __name__ == "__main__":
    main()
