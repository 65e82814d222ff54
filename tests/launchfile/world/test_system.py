import os
from pathlib import Path

import pytest

from ur.launchfile.world import PackageNotFound
from ur.launchfile.world.system import SystemWorld


def _package(folder: Path, name: str, extra: str = "") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(f"<package><name>{name}</name>{extra}</package>")
    return folder


def _world(*paths: Path, **environment: str) -> SystemWorld:
    return SystemWorld({"ROS_PACKAGE_PATH": ":".join(map(str, paths)), **environment})


def test_package_is_found_by_the_name_it_gives_itself(tmp_path: Path) -> None:
    folder = _package(tmp_path / "deep" / "folder", "my_robot")
    assert _world(tmp_path).find_package("my_robot") == str(folder)
    with pytest.raises(PackageNotFound):
        _world(tmp_path).find_package("folder")


def test_first_path_wins(tmp_path: Path) -> None:
    first = _package(tmp_path / "one" / "p", "p")
    second = _package(tmp_path / "two" / "p", "p")
    assert _world(tmp_path / "one", tmp_path / "two").find_package("p") == str(first)
    assert _world(tmp_path / "two", tmp_path / "one").find_package("p") == str(second)


def test_new_package_is_seen_by_a_new_world(tmp_path: Path) -> None:
    assert "late" not in set(_world(tmp_path).package_names())
    _package(tmp_path / "late", "late")
    assert "late" in set(_world(tmp_path).package_names())


def test_same_packages_as_rospkg(tmp_path: Path) -> None:
    rospack = pytest.importorskip("rospkg").RosPack
    _package(tmp_path / "a", "a")
    _package(tmp_path / "a" / "inside_a_package", "hidden_in_package")
    _package(tmp_path / "ignored", "ignored")
    (tmp_path / "ignored" / "CATKIN_IGNORE").touch()
    _package(tmp_path / "meta", "meta", "<export><metapackage/></export>")
    _package(tmp_path / "commented", "commented", "<!-- <name>other</name> -->")
    _package(tmp_path / "no_meta", "no_meta", "<!-- <export><metapackage/></export> --><!---->")
    _package(tmp_path / "instructed", "instructed", "<?hint <!-- ?><?hint --> ?>")
    _package(tmp_path / ".hidden" / "x", "x")
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "manifest.xml").write_text("<package/>")
    (tmp_path / "stop").mkdir()
    (tmp_path / "stop" / "rospack_nosubdirs").touch()
    _package(tmp_path / "stop" / "below", "below")
    (tmp_path / "link").symlink_to(_package(tmp_path.parent / f"{tmp_path.name}_elsewhere", "linked"))
    theirs = rospack([str(tmp_path), "/usr/share"])
    ours = _world(tmp_path)
    assert {name: ours.find_package(name) for name in ours.package_names()} == {
        name: theirs.get_path(name) for name in theirs.list()
    }


def test_comment_that_xml_does_not_allow_is_refused(tmp_path: Path) -> None:
    _package(tmp_path / "p", "p", "<!-- a -- b -->")
    with pytest.raises(ValueError, match=r"p/package\.xml"):
        _world(tmp_path).find_package("p")


def test_broken_package_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "p").mkdir()
    (tmp_path / "p" / "package.xml").write_text("<package>")
    with pytest.raises(ValueError, match=r"p/package\.xml"):
        _world(tmp_path).find_package("anything")


def test_executable_is_found_anywhere_in_its_package(tmp_path: Path) -> None:
    folder = _package(tmp_path / "p", "p") / "scripts" / "deep"
    folder.mkdir(parents=True)
    for name, mode in (("runs", 0o755), ("does_not", 0o644)):
        (folder / name).write_text("#!/bin/sh\n")
        (folder / name).chmod(mode)
    world = _world(tmp_path)
    assert world.find_executables("p", "runs") == (str(folder / "runs"),)
    assert world.find_executables("p", "does_not") == ()
    assert world.find_files("p", "does_not") == (str(folder / "does_not"),)
    assert set(world.executable_names("p")) == {"runs"}


def test_workspace_executable_wins_over_the_package_folder(tmp_path: Path) -> None:
    package = _package(tmp_path / "src" / "p", "p")
    installed = tmp_path / "devel" / "lib" / "p"
    installed.mkdir(parents=True)
    (tmp_path / "devel" / ".catkin").write_text(str(tmp_path / "src"))
    for folder in (package, installed):
        (folder / "node").write_text("#!/bin/sh\n")
        (folder / "node").chmod(0o755)
    world = _world(tmp_path / "src", CMAKE_PREFIX_PATH=str(tmp_path / "devel"))
    assert world.find_executables("p", "node") == (str(installed / "node"), str(package / "node"))
    assert world.find_in_package("p", "scripts/node") == str(installed / "node")


def test_pipe_is_refused_instead_of_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="regular"):
        _world().read_bytes(str(tmp_path / "pipe"))
