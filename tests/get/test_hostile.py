"""Folders of strangers: special files, sizes and texts that take a careless reader for ever are read or left out."""

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.limits import Used, run_limited

from ur.get.folder import folder_needs
from ur.source.diagnostic import UserError


def _zero(path: Path) -> None:
    path.symlink_to("/dev/zero")


def _write_special_files(folder: Path) -> None:
    for name in ("pipe", "device"):
        (folder / name).mkdir()
    for name in ("b.launch", "c.xacro"):
        os.mkfifo(folder / "pipe" / name)
        _zero(folder / "device" / name)
    (folder / "root").symlink_to("/")
    (folder / "kernel").symlink_to("/proc")
    (folder / "above").symlink_to("..")


def _write_texts(folder: Path) -> None:
    for name, text in (
        ("comments.launch", "<!--"),
        ("nodes.launch", "<node "),
        ("packages.launch", "<node pkg "),
    ):
        (folder / name).write_text(text * (4_000_000 // len(text)))


def _write_manifests(folder: Path) -> None:
    for name, text in (("urls", "<url "), ("types", '<url type="repository" '), ("comment", "-a")):
        (folder / name).mkdir()
        comment = f"<!--{text * (900_000 // len(text))}-->"
        (folder / name / "package.xml").write_text(f"<package><name>{name}</name>{comment}</package>")


FOLDERS: dict[str, Callable[[Path], None]] = {
    "special files": _write_special_files,
    "texts": _write_texts,
    "manifests": _write_manifests,
}


@pytest.mark.parametrize("kind", FOLDERS)
def test_folder_is_read_within_limits(tmp_path: Path, kind: str) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "a.launch").write_text('<launch><node pkg="no_such_package" type="x" name="x"/></launch>')
    FOLDERS[kind](folder)
    used = _get(folder)
    assert "no_such_package" in used.output, used.output[-2000:]
    assert (used.code, "internal error" in used.output) == (1, False)
    assert used.memory < 250_000


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda path: path.write_text("<package/>"), "no <name>"),
        (_zero, "not a regular file"),
        (os.mkfifo, "not a regular file"),
        (lambda path: path.write_text("<package>" + "<name>" * 1000), "nested deeper than"),
        (lambda path: path.write_text("<package>" + "<name>x</name>" * 100_000), "larger than"),
        (lambda path: path.write_text("<!DOCTYPE package><package/>"), "document type"),
    ],
)
def test_broken_package_is_named(tmp_path: Path, make: Callable[[Path], None], reason: str) -> None:
    (tmp_path / "a.launch").write_text('<launch><node pkg="no_such_package" type="x" name="x"/></launch>')
    (tmp_path / "p").mkdir()
    make(tmp_path / "p" / "package.xml")
    with pytest.raises(UserError, match=reason) as caught:
        folder_needs([str(tmp_path)], {})
    assert str(caught.value).startswith(f"{tmp_path}/p/package.xml: ")


def test_folder_without_a_file_to_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "robot.launch.py").write_text("")
    with pytest.raises(UserError, match="no readable launch file"):
        folder_needs([str(tmp_path)], {})


def _get(folder: Path) -> Used:
    (folder.parent / ".cache" / "ubiquity_launches").mkdir(parents=True)
    (folder.parent / ".cache" / "ubiquity_launches" / "rosdep-debian.yaml").write_text("xacro: {debian: [xacro]}\n")
    (folder.parent / "index.yaml").write_text("repositories: {}\n")
    words = ["get", "--missing", "--dry-run", "--index", str(folder.parent / "index.yaml"), str(folder)]
    environment = {"PATH": os.environ["PATH"], "HOME": str(folder.parent)}
    # `timeout` ends one that waits, the limit of processor time one that computes.
    return run_limited(["timeout", "60", sys.executable, "-I", "-m", "ur", *words], 40, folder.parent, environment)
