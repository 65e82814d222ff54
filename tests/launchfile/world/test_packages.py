"""Packages in folders of strangers: special files are named, links are followed once."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from ur.launchfile.world.packages import find_packages
from ur.launchfile.world.system import SystemWorld
from ur.source.diagnostic import UserError


def _package(folder: Path, name: str) -> None:
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(f"<package><name>{name}</name></package>")


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda path: path.symlink_to("/dev/zero"), "not a regular file"),
        (os.mkfifo, "not a regular file"),
        (lambda path: path.symlink_to("package.xml"), "symbolic links"),
        (lambda path: path.write_text("<package/>"), "no <name>"),
        (lambda path: path.write_text(" " * 1_100_000), "larger than"),
    ],
)
def test_manifest_that_cannot_be_read_is_named(tmp_path: Path, make: Callable[[Path], None], reason: str) -> None:
    _package(tmp_path / "a", "a")
    (tmp_path / "b").mkdir()
    make(tmp_path / "b" / "package.xml")
    with pytest.raises(ValueError, match=reason) as caught:
        find_packages([str(tmp_path)])
    assert isinstance(caught.value, UserError)
    assert str(caught.value).startswith(f"{tmp_path}/b/package.xml: ")


def test_links_above_and_to_the_kernel_are_not_followed(tmp_path: Path) -> None:
    top = tmp_path / "top"
    _package(top / "a", "a")
    _package(tmp_path / "elsewhere" / "b", "b")
    for name, target in (("up", ".."), ("root", "/"), ("kernel", "/proc"), ("devices", "/dev"), ("self", ".")):
        (top / name).symlink_to(target)
    (top / "good").symlink_to(tmp_path / "elsewhere")
    (top / "again").symlink_to(tmp_path / "elsewhere")
    found = find_packages([str(top)])
    assert found["a"] == f"{top}/a"
    assert found["b"] in (f"{top}/good/b", f"{top}/again/b")
    assert {"a", "b"} <= found.keys()


def test_files_of_a_package_are_searched_without_going_round_in_circles(tmp_path: Path) -> None:
    _package(tmp_path / "a", "a")
    (tmp_path / "a" / "nodes").mkdir()
    (tmp_path / "a" / "nodes" / "talker").write_text("")
    (tmp_path / "a" / "loop").symlink_to("..")
    (tmp_path / "a" / "root").symlink_to("/")
    (tmp_path / "a" / "linked").symlink_to("nodes")
    world = SystemWorld({"ROS_PACKAGE_PATH": str(tmp_path)})
    assert set(world.find_files("a", "talker")) == {f"{tmp_path}/a/{each}/talker" for each in ("nodes", "linked")}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (
            "<?xml version='1.0'?>\n<?xml-model href='a'?>\n<package><!-- <name>b</name> --><name>a</name></package>",
            True,
        ),
        ("<package><name>a</name><export><metapackage/></export></package>\n", False),
        ("<package><name>a</name><export><x/><metapackage/></export></package>", False),
        ("<package><name>a</name><!-- <export><metapackage/></export></package> --></package>", True),
        ("<package><name>a</name><description>no metapackage</description></package>", True),
        ("<package><name>a</name><?x <!-- ?><!-- <name>b</name> --></package>", True),
    ],
)
def test_metapackages_are_no_packages_and_comments_do_not_count(tmp_path: Path, text: str, found: bool) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a/package.xml").write_text(text)
    assert (find_packages([str(tmp_path)]) == {"a": str(tmp_path / "a")}) is found


def test_folder_counts_where_it_is_named_first(tmp_path: Path) -> None:
    for each in ("one", "two"):
        _package(tmp_path / each / "a", "a")
    first, second = str(tmp_path / "one"), str(tmp_path / "two")
    assert find_packages([first, second, first]) == {"a": f"{first}/a"}
