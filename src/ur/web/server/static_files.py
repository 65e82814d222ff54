"""The files of the page: read and compressed once, and served by name from a list made at the start."""

import gzip
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "static"
TYPES = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".webmanifest": "application/manifest+json",
}


@dataclass(frozen=True, slots=True)
class StaticFile:
    """A file as it is sent: its type, its bytes, its compressed bytes, and a tag that changes with the content."""

    kind: str
    plain: bytes
    packed: bytes
    tag: str


def load_files(folder: Path = FOLDER) -> Mapping[str, StaticFile]:
    """Load the files of a folder and its subfolders that have a known type, by path. Symbolic links are ignored."""
    files = {}
    for path in sorted((*folder.glob("*"), *folder.glob("*/*"))):
        if path.suffix in TYPES and path.is_file() and not path.is_symlink():
            plain = path.read_bytes()
            tag = f'"{hashlib.sha256(plain).hexdigest()[:20]}"'
            files[path.relative_to(folder).as_posix()] = StaticFile(
                TYPES[path.suffix], plain, gzip.compress(plain, 9, mtime=0), tag
            )
    return files
