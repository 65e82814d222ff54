"""Texts laid over the files of a world."""

import os
from pathlib import Path

from ur.launchfile.world import MemoryWorld, SystemWorld
from ur.launchfile.world.overlay import OverlayWorld

FILES = {"/w/one/package.xml": "<package/>", "/w/one/launch/a.launch": "<launch/>"}


def test_text_replaces_the_content_of_a_file() -> None:
    world = OverlayWorld(MemoryWorld(FILES), {"/w/one/launch/a.launch": b"<launch>"})
    assert world.read_bytes("/w/one/launch/a.launch") == b"<launch>"
    assert world.read_bytes("/w/one/package.xml") == b"<package/>"


def test_text_of_a_new_file_is_found_like_any_other() -> None:
    world = OverlayWorld(MemoryWorld(FILES, {"one": "/w/one"}), {"/w/one/launch/b.launch": b"<launch/>"})
    assert world.is_file("/w/one/launch/b.launch")
    assert not world.is_file("/w/one/launch/c.launch")
    assert world.list_folder("/w/one/launch") == ("a.launch", "b.launch")
    assert world.find_files("one", "b.launch") == ("/w/one/launch/b.launch",)
    assert world.find_files("one", "a.launch") == ("/w/one/launch/a.launch",)


def test_texts_may_change_later() -> None:
    texts: dict[str, bytes] = {}
    world = OverlayWorld(MemoryWorld(FILES), texts)
    texts["/w/one/launch/a.launch"] = b"new"
    assert world.read_bytes("/w/one/launch/a.launch") == b"new"


def test_text_is_found_through_a_link(tmp_path: Path) -> None:
    (tmp_path / "real.launch").write_text("old")
    (tmp_path / "link.launch").symlink_to("real.launch")
    texts = {os.path.realpath(tmp_path / "real.launch"): b"new"}
    world = OverlayWorld(SystemWorld({}), texts, os.path.realpath)
    assert world.read_bytes(str(tmp_path / "link.launch")) == b"new"
