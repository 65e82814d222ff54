"""One side of a sync: list a workspace's files, create a folder for arriving files, and move those into place.

It also runs on the robot, on which this project need not be installed: one file that uses only the standard library.
Run as a program it reads a request as JSON from standard input and prints the answer as JSON. A file is `[kind, size,
time of change in ns, executable, content]`; `kind` is `file`, `link` or `folder` (only empty ones), `content` the hash
of a file, the target of a link, and empty for a folder. Paths are relative to the workspace.
"""

# A robot's small computer lists thousands of files here; pathlib would take most of the time.
# ruff: noqa: PTH101, PTH103, PTH105, PTH106, PTH108, PTH111, PTH113, PTH115, PTH116, PTH118, PTH120, PTH123, PTH208, PTH211

import fnmatch
import hashlib
import json
import os
import shutil
import stat
import sys
from contextlib import suppress
from typing import Any

IGNORE_FILE = ".ursyncignore"
# Version control transfers history by itself, and a copy of a changing .git may be corrupt. The others are
# generated files.
IGNORED = (
    *(".git", ".hg", ".svn", "build/", "devel/", ".catkin_tools/", "__pycache__/", "*.pyc", "*.pyo"),
    *(".venv/", ".cache/", ".mypy_cache/", ".pytest_cache/", ".ruff_cache/", "*~", ".*.sw?", ".#*"),
)
ATTEMPTS = 5
Request = dict[str, Any]
File = list[Any]


def scan(request: Request) -> Request:
    """List the files of the workspace `root`. `ignore` are patterns; `known` are hashes by path, size and time."""
    root = os.path.realpath(os.path.expanduser(request["root"]))
    patterns = [*IGNORED, *request["ignore"], *_read_patterns(root)]
    files: dict[str, File] = {}
    skipped: dict[str, str] = {}
    with suppress(FileNotFoundError):
        device = os.stat(root).st_dev
        _walk(root, "", device, patterns, request["known"], files, skipped)
    return {
        "root": root,
        "machine": _read("/etc/machine-id").strip(),
        "rsync": shutil.which("rsync") is not None,
        "ignore": _read_patterns(root),
        "files": files,
        "skipped": skipped,
    }


def _walk(
    root: str, folder: str, device: int, patterns: list[str], known: Request, files: Request, skipped: dict[str, str]
) -> None:
    try:
        entries = sorted(os.scandir(os.path.join(root, folder)), key=lambda entry: entry.name)
    except OSError as problem:
        skipped[folder] = _reason(problem)
        return
    if not entries and folder:
        files[folder] = ["folder", 0, 0, False, ""]
    for entry in entries:
        path = os.path.join(folder, entry.name)
        try:
            is_folder = entry.is_dir(follow_symlinks=False)
            if is_ignored(path, patterns, folder=is_folder) or (not folder and _is_toplevel(entry)):
                continue
            if not is_folder:
                found = describe(os.path.join(root, path), known.get(path))
                if found:
                    files[path] = found
                else:
                    skipped[path] = "neither a file, a folder nor a link"
            elif entry.stat(follow_symlinks=False).st_dev != device:
                skipped[path] = "another file system is mounted here"
            else:
                _walk(root, path, device, patterns, known, files, skipped)
        except FileNotFoundError:  # the file was deleted meanwhile
            continue
        except OSError as problem:
            skipped[path] = _reason(problem)


def _is_toplevel(entry: os.DirEntry[str]) -> bool:
    # A link that catkin made for its own computer: it points to the local installation of catkin.
    return entry.name == "CMakeLists.txt" and entry.is_symlink()


def is_ignored(path: str, patterns: list[str], *, folder: bool = False) -> bool:
    """Return whether a path matches one of the patterns: of names at any depth, or, with a / inside, of whole paths.

    A pattern that ends in / is for folders only. The caller does not descend into ignored folders.
    """
    for pattern in patterns:
        bare = pattern.rstrip("/")
        if pattern.endswith("/") and not folder:
            continue
        text = path if "/" in bare else path.rpartition("/")[2]
        if fnmatch.fnmatchcase(text, bare.lstrip("/")):
            return True
    return False


def _read_patterns(root: str) -> list[str]:
    lines = (line.strip() for line in _read(os.path.join(root, IGNORE_FILE)).splitlines())
    return [line for line in lines if line and not line.startswith("#")]


def _read(path: str) -> str:
    try:
        with open(path, encoding="utf-8", errors="surrogateescape") as file:
            return file.read()
    except OSError:
        return ""


def describe(path: str, known: File | None = None) -> File | None:
    """Describe a file; None for one that cannot be transferred: sockets, devices.

    `known` is `[size, time, hash]`. Raises OSError.
    """
    status = os.lstat(path)
    if stat.S_ISLNK(status.st_mode):
        return ["link", 0, status.st_mtime_ns, False, os.readlink(path)]
    if stat.S_ISDIR(status.st_mode):
        return ["folder", 0, 0, False, ""]
    if not stat.S_ISREG(status.st_mode):
        return None
    same = known is not None and known[:2] == [status.st_size, status.st_mtime_ns]
    content = known[2] if same and known else _hash(path)
    return ["file", status.st_size, status.st_mtime_ns, bool(status.st_mode & 0o111), content]


def _hash(path: str) -> str:
    digest = hashlib.blake2b(digest_size=20)
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def prepare(request: Request) -> Request:
    """Create the workspace `root` and the private folder `arriving`."""
    os.makedirs(request["root"], exist_ok=True)
    for attempt in range(ATTEMPTS):
        try:
            os.makedirs(request["arriving"], mode=0o700, exist_ok=True)
            break
        except FileNotFoundError:  # a sync with another robot has just removed the parent folder
            if attempt == ATTEMPTS - 1:
                raise
    return {}


def apply(request: Request) -> Request:
    """Apply `steps`, each `[path, file as listed or null, new file or null, keep it]`; then empty `arriving`.

    A file that has changed since the listing stays unchanged, and so does one whose new content is incomplete. The
    answer has `done`, the new state of the files (null: deleted), and `left`, the reasons for unchanged ones. With the
    fourth value set, the replaced or deleted file is kept in the folder `kept`.
    """
    os.sync()  # arrived content is on the disk before it replaces any file
    done: Request = {}
    left: dict[str, str] = {}
    steps = request["steps"]
    # Deletions make space for new files; the deepest paths are deleted first.
    for step in [*sorted((s for s in steps if s[2] is None), reverse=True), *(s for s in steps if s[2] is not None)]:
        path = step[0]
        try:
            reason = _apply_one(request, *step)
        except OSError as problem:
            reason = _reason(problem)
        if reason:
            left[path] = reason
        else:
            done[path] = step[2] and _look_again(os.path.join(request["root"], path), step[2])
    os.sync()  # and the changes are on the disk before the other side records them
    shutil.rmtree(request["arriving"], ignore_errors=True)
    with suppress(OSError):
        os.rmdir(os.path.dirname(request["arriving"]))
    return {"done": done, "left": left}


def _look_again(path: str, file: File) -> File:
    status = os.lstat(path)
    size, time = (status.st_size, status.st_mtime_ns) if file[0] == "file" else (0, 0)
    return [file[0], size, time, file[3], file[4]]


def _apply_one(request: Request, path: str, before: File | None, after: File | None, keep: bool) -> str:
    root = request["root"]
    target = os.path.join(root, path)
    reason = _compare(target, before)
    if reason:
        return reason
    if after is None:
        if before and before[0] == "folder":
            with suppress(OSError):  # not empty: its content has separate paths
                os.rmdir(target)
            return ""
        _keep(request, path, keep)
        os.unlink(target)
        _remove_empty(root, os.path.dirname(path))
        return ""
    parent = os.path.dirname(target)
    os.makedirs(parent, exist_ok=True)
    if os.path.realpath(parent) != os.path.normpath(parent):
        return "its folder is a link"
    if after[0] == "folder":
        os.makedirs(target, exist_ok=True)
        return ""
    arrived = os.path.join(request["arriving"], path)
    if after[0] == "link":
        os.makedirs(os.path.dirname(arrived), exist_ok=True)
        with suppress(FileNotFoundError):
            os.unlink(arrived)
        os.symlink(after[4], arrived)
    elif not os.path.isfile(arrived) or _hash(arrived) != after[4]:
        return "it was changed meanwhile, or has not arrived whole"
    else:
        mode = os.stat(arrived).st_mode
        os.chmod(arrived, mode | (mode & 0o444) >> 2 if after[3] else mode & ~0o111)
    if before and before[0] == "folder":
        os.rmdir(target)
    elif before:
        _keep(request, path, keep)
    os.replace(arrived, target)
    return ""


def _compare(target: str, before: File | None) -> str:
    """Return the difference of a file from its listing; '' if there is none."""
    try:
        now = describe(target, [before[1], before[2], before[4]] if before else None)
    except (FileNotFoundError, NotADirectoryError):
        return "it was deleted meanwhile" if before else ""
    if now and now[0] == "folder" and (before is None or before[0] == "folder"):
        if not os.listdir(target):
            if before is None:
                os.rmdir(target)
            return ""
        return "" if before else "a folder is there"
    if before is None:
        return "it appeared meanwhile"
    if now is None or [now[0], now[3], now[4]] != [before[0], before[3], before[4]]:
        return "it was changed meanwhile"
    return ""


def _keep(request: Request, path: str, keep: bool) -> None:
    if keep:
        kept = os.path.join(request["kept"], path)
        os.makedirs(os.path.dirname(kept), exist_ok=True)
        os.link(os.path.join(request["root"], path), kept, follow_symlinks=False)


def _remove_empty(root: str, folder: str) -> None:
    while folder:
        try:
            os.rmdir(os.path.join(root, folder))
        except OSError:
            return
        folder = os.path.dirname(folder)


def _reason(problem: OSError) -> str:
    return (problem.strerror or str(problem)).lower()


def respond(text: str) -> str:
    """Answer a request; both are JSON."""
    request = json.loads(text)
    return json.dumps({"scan": scan, "prepare": prepare, "apply": apply}[request["do"]](request))


def main() -> None:
    """Answer the request on standard input."""
    sys.stdout.write(respond(sys.stdin.read()))


if __name__ == "__main__":
    main()
