"""Untrusted archives, unpacked by a separate process with limits of memory and processor time.

The headers of an archive can have any length, and the libraries that unpack archives read them whole. Run as a program,
this module unpacks its standard input.
"""

import re
import resource
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path
from typing import IO

_MEMORY = 256 * 1024 * 1024  # bytes of address space
_SECONDS = 30  # of processor time
_PATIENCE = 120.0  # s in all


def unpack_archive(data: bytes, folder: Path, names: str, *, files: int, size: int) -> None:
    """Unpack a gzipped tar archive into an existing, empty folder.

    Its members are at most `files` plain files with names that match the regular expression `names`, and have at most
    `size` bytes in total. Raises ValueError, whose text names the mistake; then some files may be in the folder.
    """
    command = [sys.executable, "-I", "-m", __name__, str(folder), names, str(files), str(size)]
    try:
        done = subprocess.run(command, input=data, capture_output=True, check=False, timeout=_PATIENCE)
    except subprocess.TimeoutExpired:
        raise ValueError("it takes too long to unpack") from None
    if done.returncode < 0:
        raise ValueError("it takes too much to unpack")
    if done.returncode:
        raise ValueError((done.stderr.decode("utf-8", "replace").strip().splitlines() or ["it is damaged"])[-1][:200])


def extract(stream: IO[bytes], folder: Path, names: str, *, files: int, size: int) -> None:
    """Unpack in this process, as `unpack_archive` does. Raises ValueError."""
    left = size
    with tarfile.open(fileobj=stream, mode="r|gz") as archive:
        for count, member in enumerate(archive):
            name = member.name.removeprefix("./")
            if member.isdir() and name in ("", "."):
                continue
            if member.type not in (tarfile.REGTYPE, tarfile.AREGTYPE) or not re.fullmatch(names, name):
                raise ValueError(f"it holds {member.name[:60]!r}")
            left -= member.size
            if count > files or left < 0:
                raise ValueError("it is too large")
            content = archive.extractfile(member)
            if content is None:
                raise ValueError(f"it holds {member.name[:60]!r}")
            with (folder / name).open("xb") as file:
                shutil.copyfileobj(content, file)


def _main(words: list[str]) -> int:
    folder, names, files, size = words
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS))
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(size), int(size)))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        extract(sys.stdin.buffer, Path(folder), names, files=int(files), size=int(size))
    except MemoryError:
        sys.stderr.write("it is too large\n")
        return 1
    except Exception as problem:
        sys.stderr.write(f"{' '.join(str(problem).split())[:200] or 'it is damaged'}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(_main(sys.argv[1:]))
