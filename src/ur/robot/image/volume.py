"""Access to files in file systems of an image or device, without mounting: mtools for FAT, debugfs for ext4."""

import os
import subprocess
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from ur.source.diagnostic import UserError, user_error, user_error_about

_SECONDS = 120.0
_TOOLS = {"debugfs": "e2fsprogs", "openssl": "openssl"}
# The administrator's tools are not on every user's PATH.
_PATH = os.pathsep.join((os.defpath, "/usr/local/sbin", "/usr/sbin", "/sbin"))


_BESIDE = ".ur-new"


def unfinished_names(names: Iterable[str]) -> frozenset[str]:
    """Return the names of files, and the names of their temporary files, which an interrupted write leaves behind."""
    return frozenset(name.removesuffix(_BESIDE) for name in names)


class Volume(Protocol):
    """A file system. Paths have no leading slash."""

    def read(self, path: str) -> bytes | None:
        """Return the content of a file; None if it does not exist.

        Raises UserError if the file system cannot be read.
        """

    def write(self, path: str, content: bytes | None, mode: int = 0o644) -> None:
        """Write this content to a file, or delete it if `content` is None. FAT ignores the mode.

        Raises UserError if the file cannot be read back afterwards.
        """


@dataclass(frozen=True, slots=True)
class FatVolume:
    """A FAT file system that begins at byte `start` of a file or device."""

    image: Path
    start: int

    def names(self) -> frozenset[str]:
        """The names in the root folder, in lower case, since FAT does not distinguish case."""
        return frozenset(
            line.removeprefix("::/").rstrip("/").lower()
            for line in self._run("mdir", "-b", "::/").decode().splitlines()
        )

    def read(self, path: str) -> bytes | None:
        """Return the content of a file in the root folder."""
        return self._run("mcopy", "-n", f"::/{path}", "-") if path in self.names() else None

    def write(self, path: str, content: bytes | None, mode: int = 0o644) -> None:  # noqa: ARG002 - of the protocol
        """Write a temporary file and rename it, so that an interrupted write leaves no partial file."""
        names = self.names()
        beside = path + _BESIDE
        if beside in names:
            self._run("mdel", f"::/{beside}")
        if content is not None:
            self._run("mcopy", "-o", "-", f"::/{beside}", stdin=content)
        if path in names:
            self._run("mdel", f"::/{path}")
        if content is not None:
            self._run("mren", f"::/{beside}", f"::/{path}")
        _compare(path, self.read(path), content)

    def _run(self, tool: str, *arguments: str, stdin: bytes = b"") -> bytes:
        # By its descriptor number: a path may contain characters that mtools interprets
        with self.image.open("rb") as file:
            place = f"/proc/self/fd/{file.fileno()}@@{self.start}"
            settings = {"MTOOLSRC": os.devnull, "MTOOLS_SKIP_CHECK": "1"}
            done = run_tool([tool, "-i", place, *arguments], stdin, pass_fds=[file.fileno()], settings=settings)
        if done.returncode:
            raise _failed(tool, done.stderr)
        return done.stdout


@dataclass(frozen=True, slots=True)
class ExtVolume:
    """An ext2, ext3 or ext4 file system that begins at byte `start` of a file or device.

    It must not be mounted, and be clean. Written files belong to root.
    """

    image: Path
    start: int

    def read(self, path: str) -> bytes | None:
        """Return the content of a file."""
        reported = self._run([f"stat {_quote(path)}"]).stderr
        if b"not found" in reported:
            return None
        return self._run([], "-R", f"cat {_quote(path)}").stdout

    def write(self, path: str, content: bytes | None, mode: int = 0o644) -> None:
        """Write or delete a file; missing parent folders are created."""
        folder, _, name = path.rpartition("/")
        parts = folder.split("/") if folder else []
        commands = (
            [f"mkdir {_quote('/'.join(parts[: i + 1]))}" for i in range(len(parts))] if content is not None else []
        )
        commands += [f"cd {_quote(folder)}", f'rm "{name}"']
        with tempfile.NamedTemporaryFile(prefix="ur-") as source:
            if content is not None:
                source.write(content)
                source.flush()
                commands += [f'write "{source.name}" "{name}"']
                owned = (("mode", f"0{0o100000 | mode:o}"), ("uid", "0"), ("gid", "0"))
                commands += [f'sif "{name}" {field} {value}' for field, value in owned]
            self._run(commands, "-w")
        _compare(path, self.read(path), content)

    def _run(self, commands: Sequence[str], *options: str) -> subprocess.CompletedProcess[bytes]:
        with self.image.open("r+b" if "-w" in options else "rb") as file:
            place = f"/proc/self/fd/{file.fileno()}?offset={self.start}"
            argv = ["debugfs", *options, *(["-f", "-"] if commands else []), place]
            done = run_tool(argv, "\n".join([*commands, ""]).encode(), pass_fds=[file.fileno()])
        if done.returncode or b"Filesystem not open" in done.stderr:
            raise _failed("debugfs", done.stderr)
        return done


def run_tool(
    argv: Sequence[str], stdin: bytes = b"", *, pass_fds: Sequence[int] = (), settings: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[bytes]:
    """Run a program that ends soon. Raises UserError if it is not installed, or does not end."""
    path = f"{os.environ.get('PATH', '')}{os.pathsep}{_PATH}"
    try:
        return subprocess.run(
            argv,
            input=stdin,
            capture_output=True,
            pass_fds=pass_fds,
            env={**os.environ, "PATH": path, "LC_ALL": "C", **(settings or {})},
            timeout=_SECONDS,
            check=False,
        )
    except (FileNotFoundError, PermissionError):  # the latter if a folder of PATH belongs to another user
        package = _TOOLS.get(argv[0], "mtools")
        raise user_error(
            f"{argv[0]} is not installed here, needed to look into images",
            rule="missing-program",
            help=f"run: sudo apt-get install {package}",
            subject=argv[0],
        ) from None
    except subprocess.TimeoutExpired:
        raise _failed(argv[0], b"no answer") from None


def _quote(path: str) -> str:
    return f'"/{path}"'


def _compare(path: str, found: bytes | None, wanted: bytes | None) -> None:
    if found != wanted:
        raise user_error_about(
            path, "the written file cannot be read back", rule="failed-change", help="is its disk full?"
        )


def _failed(tool: str, reported: bytes) -> UserError:
    lines = [line for line in reported.decode(errors="replace").splitlines() if line.strip()]
    lines = [line for line in lines if not line.startswith("debugfs 1.")] or ["no reason was given"]
    return user_error(
        f"its file system cannot be used: {tool}: {lines[0]}", rule="damaged-image", help="flash it again"
    )
