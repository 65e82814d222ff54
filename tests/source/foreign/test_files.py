"""Special files, endless files and files outside of a folder are refused without waiting for them."""

import os
import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from ur.source.foreign.files import open_file, read_file, read_text


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(path))


def _sparse(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(1 << 40)


@pytest.mark.parametrize("read", [read_file, open_file])
@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (os.mkfifo, "not a regular file"),
        (Path.mkdir, "not a regular file"),
        (_socket, "not a regular file"),
        (_sparse, "larger than"),
        (lambda path: path.symlink_to("/dev/zero"), "not a regular file"),
        (lambda path: path.symlink_to(path.name), "symbolic links"),
    ],
)
def test_what_is_no_file_is_refused(
    tmp_path: Path, make: Callable[[Path], None], reason: str, read: Callable[[Path], object]
) -> None:
    make(tmp_path / "file")
    with pytest.raises(OSError, match=reason) as caught:
        read(tmp_path / "file")
    assert caught.value.filename == str(tmp_path / "file")


def test_limit_counts_what_is_read() -> None:
    assert read_file("/proc/self/status")  # a file without a size
    with pytest.raises(OSError, match="larger than 100 bytes"):
        read_file("/proc/self/status", 100)


def test_file_of_exactly_the_limit_is_read(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"x" * 100_000)
    assert read_file(tmp_path / "file", 100_000) == b"x" * 100_000
    with pytest.raises(OSError, match="larger than 99,999 bytes"):
        read_file(tmp_path / "file", 99_999)


def test_path_with_a_nul_character_is_refused() -> None:
    with pytest.raises(OSError, match="NUL"):
        read_file("a\0b")


def test_links_out_of_a_folder_are_refused(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    (inner / "deeper").mkdir(parents=True)
    (tmp_path / "secret").write_text("s")
    (tmp_path / "inner-2").write_text("s")
    (inner / "good").write_text("g")
    (inner / "deeper" / "link").symlink_to("../good")
    assert read_file(inner / "deeper" / "link", inside=inner) == b"g"
    (inner / "file").symlink_to(tmp_path / "secret")
    (inner / "folder").symlink_to(tmp_path)
    for name in ("file", "folder/secret", "../secret", "../inner-2"):
        with pytest.raises(OSError, match="outside of the folder"):
            read_file(inner / name, inside=inner)


def test_text_has_plain_line_breaks(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"a\r\nb\rc\xff")
    assert read_text(tmp_path / "file") == "a\nb\nc\ufffd"
    with pytest.raises(ValueError, match="utf-8"):
        read_text(tmp_path / "file", errors="strict")
