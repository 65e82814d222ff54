import bz2
import gzip
import lzma
import os
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from ur.robot.image.copy import copied_image, packing_of
from ur.source.diagnostic import UserError

CONTENT = b"start" + bytes(3 << 20) + b"end" + bytes(5000)


def pack(path: Path, kind: str) -> Path:
    if kind == "zip":
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("read.me", "x")
            archive.writestr("inner.img", CONTENT)
        return path
    packers: dict[str, Callable[[bytes], bytes]] = {"xz": lzma.compress, "gzip": gzip.compress, "bzip2": bz2.compress}
    path.write_bytes(packers[kind](CONTENT) if kind in packers else CONTENT)
    return path


def silent(done: int, total: int) -> None:
    assert done <= total


@pytest.mark.parametrize("kind", ["xz", "gzip", "bzip2", "zip", "none"])
def test_copy_is_the_same_and_appears_in_one_step(tmp_path: Path, kind: str) -> None:
    source, target = pack(tmp_path / "source", kind), tmp_path / "x.img"
    assert packing_of(source) == (None if kind == "none" else kind)
    with copied_image(source, target, silent) as (beside, finish):
        assert beside.read_bytes() == CONTENT
        assert not target.exists()
        finish()
    assert target.read_bytes() == CONTENT
    assert {each.name for each in tmp_path.iterdir()} == {"source", "x.img"}


def test_stretches_of_nothing_take_no_room(tmp_path: Path) -> None:
    with copied_image(pack(tmp_path / "source", "xz"), tmp_path / "x.img", silent) as (beside, _):
        status = beside.stat()
    if status.st_blocks * 512 >= len(CONTENT):
        pytest.skip("this file system has no holes")
    assert status.st_blocks * 512 < 3 << 20


@pytest.mark.parametrize("kind", ["xz", "gzip", "bzip2", "zip"])
def test_damaged_download_is_one_line_and_leaves_nothing(tmp_path: Path, kind: str) -> None:
    source = pack(tmp_path / "source", kind)
    source.write_bytes(source.read_bytes()[:-30])
    with (
        pytest.raises(UserError, match="is damaged"),
        copied_image(source, tmp_path / "x.img", silent),
    ):
        pass
    assert [each.name for each in tmp_path.iterdir()] == ["source"]


def test_failure_before_the_end_leaves_the_old_one(tmp_path: Path) -> None:
    source = pack(tmp_path / "x.img", "none")

    def interrupted() -> None:
        with copied_image(source, source, silent) as (beside, _):
            beside.write_bytes(b"half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert source.read_bytes() == CONTENT
    assert [each.name for each in tmp_path.iterdir()] == ["x.img"]


def test_what_a_killed_process_left_is_removed_and_that_of_others_stays(tmp_path: Path) -> None:
    ended = subprocess.Popen(["true"])
    ended.wait()
    left, busy = (tmp_path / f".x.img.{number}.ur-unfinished" for number in (ended.pid, os.getppid()))
    left.touch()
    busy.touch()
    with copied_image(pack(tmp_path / "source", "none"), tmp_path / "x.img", silent) as (_, finish):
        finish()
    assert not left.exists()
    assert busy.exists()


def test_archive_of_several_images_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "x.zip", "w") as archive:
        archive.writestr("a.img", "a")
        archive.writestr("b.img", "b")
    with pytest.raises(UserError, match="holds 2 images"), copied_image(tmp_path / "x.zip", tmp_path / "x", silent):
        pass


def test_zstd_comes_with_the_command_that_unpacks_it(tmp_path: Path) -> None:
    source = tmp_path / "x.img.zst"
    source.write_bytes(b"\x28\xb5\x2f\xfd" + bytes(20))
    with pytest.raises(UserError) as caught, copied_image(source, tmp_path / "x", silent):
        pass
    assert caught.value.diagnostics[0].help == f"run: zstd -d {source}"


def test_folder_that_may_not_be_written_is_named(tmp_path: Path) -> None:
    source = pack(tmp_path / "source", "none")
    with pytest.raises(UserError, match="cannot be written"), copied_image(source, tmp_path / "no/x", silent):
        pass


@pytest.mark.parametrize("mode", [0o444, 0o644, 0o666])
def test_only_the_user_may_read_a_copy_from_its_first_byte_on(tmp_path: Path, mode: int) -> None:
    source, target = pack(tmp_path / "source", "none"), tmp_path / "x.img"
    source.chmod(mode)
    target.touch()
    target.chmod(mode)
    modes: set[int] = set()

    def observe(done: int, total: int) -> None:  # noqa: ARG001 - Progress
        modes.update(each.stat().st_mode & 0o777 for each in tmp_path.glob(".x.img.*"))

    before = os.umask(0)
    try:
        with copied_image(source, target, observe) as (_, finish):
            finish()
    finally:
        os.umask(before)
    assert modes == {0o600}
    assert target.stat().st_mode & 0o777 == 0o600
