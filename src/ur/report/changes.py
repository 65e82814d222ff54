"""Changes of a workspace since its last commit, by git, which reads no settings of the workspace.

A repository names programs in its `config`: filters, hooks, a monitor of files, drivers of differences, signatures. git
gets a folder of ours as the repository instead, with the workspace's objects and a copy of its index.
"""

import os
import re
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ur.source.foreign.files import read_file, read_text

_MOST_CHANGES = 4_000_000  # bytes, with all lines of the files
_MOST_INDEX = 64_000_000
_LIMITS = ("timeout", "--signal=KILL", "2", "prlimit", f"--as={1 << 30}", "--")  # s, bytes
_FILE = re.compile(r"(?:---|\+\+\+) (?:[ab]/(.*)|/dev/null)")
_COMMIT = re.compile("[0-9a-f]{40}")
_POINTER = re.compile("(?:gitdir|ref): (.{1,4000})")


@dataclass(frozen=True, slots=True)
class WorkspaceChanges:
    """The commit and the differences as a text, and both versions of the files that differ, with their names."""

    text: str = ""
    versions: tuple[tuple[str, str], ...] = ()


def read_changes(folder: Path) -> WorkspaceChanges:
    """Return the changes of the repository that a folder is in; none without a repository, or if they are too many."""
    top = next((each for each in (folder, *folder.parents) if (each / ".git").exists()), None)
    try:
        with tempfile.TemporaryDirectory(prefix="ur_report_") as own:
            return WorkspaceChanges() if top is None else _read_changes(top.resolve(), Path(own))
    except (OSError, ValueError, subprocess.SubprocessError):
        return WorkspaceChanges()


def _read_changes(top: Path, own: Path) -> WorkspaceChanges:
    settings = top / ".git"
    if settings.is_file():  # of another work tree, or a submodule
        settings = top / _follow(read_text(settings, 4096).strip())
    shared = settings / "commondir"
    common = settings / read_text(shared, 4096).strip() if shared.exists() else settings
    commit = _find_commit(settings, common)
    for name in ("objects", "refs"):
        (own / name).mkdir()
    (own / "HEAD").write_text(commit)
    if (settings / "index").exists():
        (own / "index").write_bytes(read_file(settings / "index", _MOST_INDEX))
        written = (settings / "index").stat().st_mtime_ns  # by which git knows files that changed in the same moment
        os.utime(own / "index", ns=(written, written))
    environment = {
        "PATH": os.defpath,
        "LC_ALL": "C.UTF-8",
        "GIT_DIR": str(own),
        "GIT_WORK_TREE": str(top),
        "GIT_OBJECT_DIRECTORY": str(common / "objects"),
        "GIT_CONFIG_GLOBAL": os.devnull,
        "GIT_CONFIG_NOSYSTEM": "1",
        "GIT_ATTR_NOSYSTEM": "1",
        "GIT_NO_LAZY_FETCH": "1",
    }
    text, whole = (_run_git(environment, (context, "--stat", "--patch", commit)) for context in ("-U3", "-U1000000"))
    return WorkspaceChanges(f"commit {commit}\n\n{text}", tuple(_split_versions(whole)))


def _run_git(environment: dict[str, str], words: tuple[str, ...]) -> str:
    """Return what 'git diff' prints. Raises OSError where it fails, and for more than _MOST_CHANGES."""
    options = ("--no-ext-diff", "--no-textconv", "--no-color", "--no-renames", "--ignore-submodules=all")
    with subprocess.Popen(
        [*_LIMITS, "git", "diff", *options, *words],
        env=environment,
        cwd=environment["GIT_WORK_TREE"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    ) as process:
        assert process.stdout is not None
        output = process.stdout.read(_MOST_CHANGES + 1)
        if len(output) > _MOST_CHANGES:
            process.kill()
    if process.returncode:
        raise OSError(f"git ended with exit code {process.returncode}")
    return output.decode("utf-8", "replace")


def _split_versions(whole: str) -> Iterator[tuple[str, str]]:
    """Yield the versions of files, each with its name, of differences with all lines around them."""
    for section in f"\n{whole}".split("\ndiff --git ")[1:]:
        head, _, body = section.partition("\n@@ ")
        names = [found[1] for line in head.splitlines() if (found := _FILE.fullmatch(line)) and found[1]]
        lines = body.splitlines()[1:]
        for sign in "-+":
            text = "".join(f"{line[1:]}\n" for line in lines if line[:1] in (sign, " "))
            yield names[-1] if names else "", text


def _find_commit(settings: Path, common: Path) -> str:
    """Return the commit of HEAD. Raises OSError, ValueError."""
    name = "HEAD"
    for _ in range(5):
        place = next((each / name for each in (settings, common) if (each / name).is_file()), None)
        if place is None:
            lines = (each.split(" ", 1) for each in read_text(common / "packed-refs").splitlines() if " " in each)
            text = next(commit for commit, known in lines if known == name)
        else:
            text = read_text(place, 4096).strip()
        if _COMMIT.fullmatch(text):
            return text
        name = _follow(text)
        if ".." in name.split("/") or not name.startswith("refs/"):
            raise ValueError(name)
    raise ValueError(name)


def _follow(text: str) -> str:
    found = _POINTER.fullmatch(text)
    if found is None:
        raise ValueError(text)
    return found[1]
