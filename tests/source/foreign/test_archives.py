"""Archives whose headers promise more than anything may hold, and archives with other files than expected."""

import io
import tarfile
import zlib
from pathlib import Path

import pytest

from ur.source.foreign.archives import unpack_archive

NAMES = r"[a-z]{1,9}"
BLOCK = bytes(16 << 20)


def _pack(*members: tuple[tarfile.TarInfo, bytes], **options: int) -> bytes:
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz", **options) as archive:  # type: ignore[call-overload]
        for info, data in members:
            info.size = len(data)
            archive.addfile(info, io.BytesIO(data))
    return buffer.getvalue()


def _huge(kind: bytes, size: int) -> bytes:
    """One member with `size` bytes of zeros, packed without compressing each of them."""
    info = tarfile.TarInfo("a")
    info.type, info.size = kind, size
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    head = packer.compress(info.tobuf(tarfile.GNU_FORMAT)) + packer.flush(zlib.Z_FULL_FLUSH)
    block = packer.compress(BLOCK) + packer.flush(zlib.Z_FULL_FLUSH)
    return head + block * (size // len(BLOCK)) + packer.flush()


def _unpack(data: bytes, folder: Path) -> list[str]:
    folder.mkdir()
    unpack_archive(data, folder, NAMES, files=3, size=1_000_000)
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("kind", [tarfile.GNUTYPE_LONGNAME, tarfile.XHDTYPE])
def test_headers_of_gigabytes_are_refused(tmp_path: Path, kind: bytes) -> None:
    with pytest.raises(ValueError, match=r"too large|too much"):
        _unpack(_huge(kind, 2 << 30), tmp_path / "f")


@pytest.mark.parametrize("kind", [tarfile.REGTYPE, tarfile.GNUTYPE_SPARSE, tarfile.CONTTYPE])
def test_large_files_are_refused(tmp_path: Path, kind: bytes) -> None:
    with pytest.raises(ValueError, match=r"too large|it holds 'a'"):
        _unpack(_huge(kind, 1 << 30), tmp_path / "f")


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        (tarfile.SYMTYPE, "a"),
        (tarfile.LNKTYPE, "a"),
        (tarfile.FIFOTYPE, "a"),
        (tarfile.CHRTYPE, "a"),
        (tarfile.DIRTYPE, "a"),
        (tarfile.REGTYPE, "../a"),
        (tarfile.REGTYPE, "/a"),
        (tarfile.REGTYPE, "a/b"),
        (tarfile.REGTYPE, "A"),
        (tarfile.REGTYPE, "a\n"),
    ],
)
def test_other_members_are_refused(tmp_path: Path, kind: bytes, name: str) -> None:
    info = tarfile.TarInfo(name)
    info.type, info.linkname = kind, "/etc/passwd"
    with pytest.raises(ValueError, match="it holds"):
        _unpack(_pack((info, b"")), tmp_path / "f")
    assert list(tmp_path.iterdir()) == [tmp_path / "f"]


def test_sparse_file_by_a_header_is_refused(tmp_path: Path) -> None:
    info = tarfile.TarInfo("a")
    info.pax_headers = {"GNU.sparse.major": "1", "GNU.sparse.minor": "0", "GNU.sparse.realsize": str(1 << 50)}
    with pytest.raises(ValueError, match=r"not enough values|it holds|too large"):
        _unpack(_pack((info, b"99999999\n" + b"0\n" * 500), format=tarfile.PAX_FORMAT), tmp_path / "f")


@pytest.mark.parametrize(
    "data",
    [b"", b"\x1f\x8b", b"x" * 10_000, _pack((tarfile.TarInfo("a"), b"x" * 99))[:-30]],
    ids=["empty", "head alone", "no archive", "cut off"],
)
def test_damaged_archive_is_refused_in_one_line(tmp_path: Path, data: bytes) -> None:
    with pytest.raises(ValueError, match=r"^[^\n]+$"):
        _unpack(data, tmp_path / "f")


def test_files_are_unpacked_and_counted(tmp_path: Path) -> None:
    members = [(tarfile.TarInfo(name), name.encode()) for name in ("a", "./b", "c")]
    assert _unpack(_pack(*members), tmp_path / "f") == ["a", "b", "c"]
    assert (tmp_path / "f" / "b").read_bytes() == b"./b"
    with pytest.raises(ValueError, match="too large"):
        _unpack(_pack(*members, *((tarfile.TarInfo(name), b"") for name in "defg")), tmp_path / "g")
    with pytest.raises(ValueError, match="too large"):
        _unpack(_pack((tarfile.TarInfo("a"), b"x" * 600_000), (tarfile.TarInfo("b"), b"x" * 600_000)), tmp_path / "h")
