"""Inputs that describe files: special files, and sizes that no mutation of a short text reaches.

An input is parts between lines of `====`. The first line of a part is a name and a kind; the rest is its content:

    b.launch file       README.md pipe       x device      y socket      z folder
    w sparse 1000000    v link /             u link x

`{{4000000 x [}}` in an input stands for so many `[`.
"""

import os
import re
import socket
from contextlib import suppress
from pathlib import Path

_REPEAT = re.compile(rb"\{\{(\d{1,8}) x ((?:(?!\}\}).){1,60})\}\}", re.DOTALL)
_LARGEST = 8_000_000  # bytes of all repeats of an input
_NAME = re.compile(rb"[A-Za-z0-9._-]{1,40}(/[A-Za-z0-9._-]{1,40}){0,2}")
_TARGETS = ("/", "/proc", "/dev/zero", "..", ".", "/etc/passwd", "a", "b")
CUT = b"\n====\n"
WORDS = (
    *(b" pipe\n", b" device\n", b" socket\n", b" folder\n", b" file\n", b" sparse 99999999999\n"),
    *(f" link {target}\n".encode() for target in _TARGETS),
    *(b"{{400000 x [}}", b"{{400000 x {a: }}", b"{{400000 x - }}", b"{{400000 x <a>}}", b"{{400000 x <!--}}"),
    *(
        b"{{400000 x \n}}",
        b"{{400000 x  }}",
        b"{{400000 x 9}}",
        b"{{400000 x :59}}",
        b"{{400000 x a}}",
        b"{{4000000 x #}}",
    ),
    CUT,
)


def expand(data: bytes) -> bytes:
    """The input with its repeats written out, as far as they fit into a few megabytes."""
    left = _LARGEST

    def repeat(found: re.Match[bytes]) -> bytes:
        nonlocal left
        count = min(int(found[1]), left // len(found[2]))
        left -= count * len(found[2])
        return found[2] * count

    return _REPEAT.sub(repeat, data)


def make_files(data: bytes, folder: Path) -> None:
    """Make the files that an input describes, all below the folder; a part that cannot be made is left out."""
    for part in data.split(CUT):
        head, _, content = part.partition(b"\n")
        name, kind, *rest = [*head.split()[:3], b"", b""][:3]
        if _NAME.fullmatch(name) is None or b".." in name:
            continue
        path = folder / name.decode()
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            _make(path, kind, rest[0], content)


def _make(path: Path, kind: bytes, more: bytes, content: bytes) -> None:
    match kind:
        case b"pipe":
            os.mkfifo(path)
        case b"device":
            path.symlink_to("/dev/zero")
        case b"folder":
            path.mkdir()
        case b"socket":
            with socket.socket(socket.AF_UNIX) as server:
                server.bind(str(path))
        case b"sparse":
            with path.open("xb") as file:
                file.truncate(min(int(more) if more.isdigit() and len(more) < 13 else 0, 1 << 40))
        case b"link":
            path.symlink_to(next((each for each in _TARGETS if each.encode() == more), "a"))
        case _:
            path.write_bytes(content)
