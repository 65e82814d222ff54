"""What belongs to a description is found up to the first folder that somebody else may write to."""

import os
from pathlib import Path

import pytest

from ur.robot.description.surroundings import Surroundings, find_surroundings, is_safe_program


def make(tmp_path: Path, *files: str) -> Path:
    for name in files:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("", encoding="utf-8")
    return tmp_path / files[0]


def look(file: Path, home: str = "/nonexistent") -> Surroundings:
    return find_surroundings(file, {"HOME": home})


def test_package_and_those_beside_it_are_found(tmp_path: Path) -> None:
    file = make(tmp_path, "ws/bot/urdf/a.urdf", "ws/bot/package.xml", "ws/arm/package.xml", "ws/no/readme")
    (tmp_path / "far").mkdir()
    make(tmp_path, "far/package.xml")
    (tmp_path / "ws/link").symlink_to(tmp_path / "far")
    found = look(file)
    assert found.packages == (tmp_path / "ws/bot", tmp_path / "ws/arm")
    assert found.folder == tmp_path / "ws/bot"


@pytest.mark.parametrize(
    ("files", "folder"),
    [
        (["a.urdf"], ""),
        (["urdf/a.urdf"], ""),
        (["parts/a.urdf"], "parts"),
        (["repository/bot/urdf/a.urdf", "repository/.git/config", "repository/bot/package.xml"], "repository"),
    ],
    ids=["alone", "customary folder", "other folder", "repository"],
)
def test_folder_of_a_description_is_its_repository_package_or_own(
    tmp_path: Path, files: list[str], folder: str
) -> None:
    file = make(tmp_path / "x", *files)
    assert look(file).folder == tmp_path / "x" / folder


@pytest.mark.parametrize("mode", [0o1777, 0o777, 0o757])
def test_nothing_is_found_from_a_folder_that_all_may_write_to_on(tmp_path: Path, mode: int) -> None:
    file = make(tmp_path, "shared/mine/a.urdf", "shared/package.xml", "shared/arm/package.xml", "shared/.git/config")
    (tmp_path / "shared").chmod(mode)
    assert (look(file).packages, look(file).folder) == ((), tmp_path / "shared/mine")
    inside = make(tmp_path, "shared/mine/package.xml").with_name("a.urdf")
    assert look(inside).packages == (tmp_path / "shared/mine",)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files to other users")
@pytest.mark.parametrize("owner", [1, 65534])
def test_nothing_is_found_from_a_folder_of_another_user_on(tmp_path: Path, owner: int) -> None:
    file = make(tmp_path, "theirs/mine/a.urdf", "theirs/package.xml")
    os.chown(tmp_path / "theirs", owner, owner)
    assert look(file).packages == ()
    os.chown(file, owner, owner)
    assert look(file).packages == (tmp_path / "theirs",), "the description is of the same user"


def test_home_folder_is_neither_a_repository_nor_read(tmp_path: Path) -> None:
    file = make(tmp_path, "bot/a.urdf", ".git/config", "package.xml", "other/b.stl", "c.stl")
    found = look(file, str(tmp_path))
    assert (found.folder, found.packages) == (tmp_path / "bot", ())
    directly = look(make(tmp_path, "a.urdf"), str(tmp_path))
    assert directly.find_readable(tmp_path / "c.stl")
    assert not directly.find_readable(tmp_path / "other/b.stl")
    assert not look(file, str(tmp_path / "bot/in")).find_readable(tmp_path / "c.stl")


def test_readable_is_what_lies_in_it_wherever_links_lead_and_is_not_hidden(tmp_path: Path) -> None:
    file = make(tmp_path, "bot/urdf/a.urdf", "bot/package.xml", "bot/.git/config", "bot/b.stl", "out/c.stl", "p/d.stl")
    (tmp_path / "bot/link.stl").symlink_to(tmp_path / "out/c.stl")
    (tmp_path / "bot/inner.stl").symlink_to(tmp_path / "bot/b.stl")
    found = look(file)
    assert found.find_readable(tmp_path / "bot/inner.stl") == tmp_path / "bot/b.stl"
    assert found.find_readable(tmp_path / "p/d.stl", [str(tmp_path / "p")])
    for name in ("bot/link.stl", "bot/.git/config", "out/c.stl", "bot/../out/c.stl", "p/d.stl"):
        assert found.find_readable(tmp_path / name) is None, name


def test_program_that_all_may_write_to_is_not_safe(tmp_path: Path) -> None:
    program = make(tmp_path, "bin/xacro")
    assert is_safe_program(str(program))
    (tmp_path / "link").mkdir()
    (tmp_path / "link/xacro").symlink_to(program)
    assert is_safe_program(str(tmp_path / "link/xacro"))
    (tmp_path / "bin").chmod(0o1777)
    assert not is_safe_program(str(program))
    assert not is_safe_program(str(tmp_path / "link/xacro"))
    (tmp_path / "bin").chmod(0o755)
    program.chmod(0o757)
    assert not is_safe_program(str(program))
