"""A file is replaced completely or not at all, keeps its links and permissions, and is never writable for everybody."""

import os
import re
import shutil
import stat
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from ur.source.replace import PRIVATE, replace_file, replacing


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture
def umask() -> Iterator[None]:
    before = os.umask(0o022)
    yield
    os.umask(before)


def test_link_stays_and_its_target_is_written(tmp_path: Path) -> None:
    (tmp_path / "dotfiles").mkdir()
    target = tmp_path / "dotfiles" / "selection"
    target.write_text("old")
    link = tmp_path / "selection"
    link.symlink_to("dotfiles/selection")
    replace_file(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert names_in(tmp_path / "dotfiles") == ["selection"]


def test_link_to_nothing_makes_its_target(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("target")
    replace_file(tmp_path / "link", b"\xff new")
    assert (tmp_path / "target").read_bytes() == b"\xff new"


def test_permissions_of_a_file_stay(tmp_path: Path) -> None:
    path = tmp_path / "program"
    path.write_text("old")
    path.chmod(0o4751)
    replace_file(path, "new")
    assert stat.S_IMODE(path.stat().st_mode) == 0o4751


@pytest.mark.usefixtures("umask")
@pytest.mark.parametrize(
    ("mask", "public", "private"), [(0o000, 0o664, 0o600), (0o022, 0o644, 0o600), (0o077, 0o600, 0o600)]
)
def test_new_files_are_never_writable_for_everybody(tmp_path: Path, mask: int, public: int, private: int) -> None:
    os.umask(mask)
    replace_file(tmp_path / "a" / "public", "", parents=True)
    replace_file(tmp_path / "private", "", mode=PRIVATE)
    assert stat.S_IMODE((tmp_path / "a" / "public").stat().st_mode) == public
    assert stat.S_IMODE((tmp_path / "private").stat().st_mode) == private
    assert not (tmp_path / "a").stat().st_mode & 0o002


def test_folder_that_is_gone_is_not_made_again(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        replace_file(tmp_path / "run" / "clients", "")
    assert names_in(tmp_path) == []


@pytest.mark.parametrize("kind", ["fifo", "folder"])
def test_what_is_no_file_is_not_replaced(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "it"
    os.mkfifo(path) if kind == "fifo" else path.mkdir()
    with pytest.raises(OSError, match=r"regular|directory"):
        replace_file(path, "new")
    assert names_in(tmp_path) == ["it"]


def test_nothing_is_left_when_the_file_cannot_be_written(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("old")
    code = (
        "import resource, signal, sys; from ur.source.replace import replace_file; "
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); resource.setrlimit(resource.RLIMIT_FSIZE, (10, 10)); "
        "replace_file(sys.argv[1], 'new' * 100)"
    )
    done = subprocess.run([sys.executable, "-I", "-c", code, str(path)], capture_output=True, text=True, check=False)
    assert "File too large" in done.stderr
    assert path.read_text() == "old"
    assert names_in(tmp_path) == ["file"]


@pytest.mark.skipif(not shutil.which("strace"), reason="needs strace")
def test_content_reaches_the_disk_before_the_name_and_the_name_before_the_return(tmp_path: Path) -> None:
    code = "import sys; from ur.source.replace import replace_file; replace_file(sys.argv[1], 'new', parents=True)"
    calls = "trace=write,fsync,rename,renameat,renameat2,mkdir,mkdirat"
    command = ["strace", "-y", "-e", calls, sys.executable, "-I", "-c", code, str(tmp_path / "made" / "file")]
    log = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    steps = re.findall(rf"^(\w+)\([^\n]*{re.escape(str(tmp_path))}", log, re.MULTILINE)
    assert [each.removesuffix("at") for each in steps] == ["mkdir", "fsync", "write", "fsync", "rename", "fsync"]


def test_cache_costs_no_flush(tmp_path: Path) -> None:
    flushed: list[int] = []
    replace_file(tmp_path / "a" / "cache", "new", parents=True, lasting=False, sync=flushed.append)
    assert (tmp_path / "a" / "cache").read_text() == "new"
    assert flushed == []


def test_unfinished_files_of_killed_processes_are_removed_and_those_of_others_stay(tmp_path: Path) -> None:
    names = {name: tmp_path / f".{name}.01234567.ur-new" for name in ("old", "young", "link", "pipe")}
    names["old"].write_text("")
    names["young"].write_text("")
    names["link"].symlink_to(tmp_path / "precious")
    os.mkfifo(names["pipe"])
    (tmp_path / "precious").write_text("")
    with replacing(tmp_path / "writing") as file:
        (unfinished,) = (each for each in tmp_path.iterdir() if each.name.startswith(".writing"))
        for each in (names["old"], names["link"], names["pipe"], unfinished, tmp_path / "precious"):
            os.utime(each, (1.0, 1.0), follow_symlinks=False)
        replace_file(tmp_path / "other", "")
        assert unfinished.exists()
        assert not names["old"].exists()
        file.write(b"done")
    assert (tmp_path / "writing").read_text() == "done"
    assert names_in(tmp_path) == [
        *(".link.01234567.ur-new", ".pipe.01234567.ur-new", ".young.01234567.ur-new"),
        *("other", "precious", "writing"),
    ]


def test_file_that_cannot_be_written_is_named_as_the_user_names_it() -> None:
    with pytest.raises(OSError, match=r"/proc/flat\.yaml") as caught:
        replace_file("/proc/flat.yaml", "")
    assert caught.value.filename == "/proc/flat.yaml"
