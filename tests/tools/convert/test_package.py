"""Packages: all launch files of a folder with their places, what is left out, and the folder they are written to."""

from pathlib import Path

import pytest

from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import UserError
from ur.tools.convert.package import ConvertedFiles, convert_all
from ur.tools.convert.write import write_output, write_prefix

NODE = '<launch><node pkg="one" type="t" name="a"><rosparam file="$(find {})/params/a.yaml"/></node></launch>'
FILES = {
    "/w/one/package.xml": "<package><name>one</name></package>",
    "/w/one/launch/top.launch": NODE.format("one"),
    "/w/one/params/a.yaml": "rate: 1\n",
    "/w/two/package.xml": "<package><name>two</name></package>",
    "/w/two/launch/top.launch": NODE.format("one"),
    "/w/two/params/a.yaml": "rate: 2\n",
    "/alone/top.launch": "<launch/>",
}


def convert(path: str, files: dict[str, str] | None = None, *, whole: bool = False) -> ConvertedFiles:
    world = MemoryWorld(FILES | (files or {}), {"one": "/w/one", "two": "/w/two"})
    return convert_all(path, world, lambda _text: None, whole=whole)


def test_files_of_a_folder_keep_their_places_in_their_packages() -> None:
    made = convert("/w")
    assert [(each.package, each.place) for each in made.launch_files] == [
        ("one", "launch/top.launch"),
        ("two", "launch/top.launch"),
    ]
    assert [(each.package, each.place) for each in made.parameter_files] == [("one", "params/a.yaml")]
    assert made.packages == {"one": "/w/one", "two": "/w/two"}
    assert made.findings == ()


def test_parameters_of_a_package_that_is_not_converted_are_named() -> None:
    made = convert("/w/two")
    (found,) = made.findings
    assert made.parameter_files == ()
    assert found.message == "/w/one/params/a.yaml: parameters of another package, which are not converted"
    assert found.help == "convert that package, too"


def test_folder_without_a_launch_file_is_refused() -> None:
    with pytest.raises(UserError, match="no launch file in it, expected one to convert"):
        convert("/w/one/params")


def test_file_that_cannot_be_read_is_named_and_the_others_are_converted() -> None:
    made = convert("/w/one", {"/w/one/launch/bad.launch": "<launch><node></launch>"})
    assert [each.place for each in made.launch_files] == ["launch/top.launch"]
    assert [found.span.file.path for found in made.findings if found.span] == ["/w/one/launch/bad.launch"]


def test_only_file_that_cannot_be_read_is_refused() -> None:
    with pytest.raises(UserError):
        convert("/alone", {"/alone/top.launch": "<launch><node></launch>"})


def test_file_outside_of_a_package_is_converted_unless_packages_are_wanted() -> None:
    (file,) = convert("/alone/top.launch").launch_files
    assert (file.package, file.place) == ("", "top.launch")
    with pytest.raises(UserError) as problem:
        convert("/alone/top.launch", whole=True)
    (found,) = problem.value.diagnostics
    assert "not in a package, expected launch files of one" in found.message
    assert found.help == "--output converts them where they are"


def test_output_of_several_packages_has_a_folder_for_each(tmp_path: Path) -> None:
    write_output(convert("/w"), tmp_path / "made")
    write_output(convert("/w/one"), tmp_path / "single")
    assert (tmp_path / "made/two/launch/top.launch").read_text().startswith("<?xml")
    assert "rate: 1" in (tmp_path / "made/one/params/a.yaml").read_text()
    assert (tmp_path / "single/launch/top.launch").is_file()


def test_prefix_links_the_other_files_and_programs_of_a_package(tmp_path: Path) -> None:
    source, prefix = tmp_path / "one", tmp_path / "prefix"
    (source / "bin").mkdir(parents=True)
    (source / ".git").mkdir()
    (source / ".git/config").touch()
    (source / "bin/talk").touch(mode=0o755)
    (source / "top.launch").write_text("old")
    made = convert("/w/one")
    files = ConvertedFiles(made.launch_files, made.parameter_files, {"one": str(source)}, ())
    for _ in range(2):  # into the folder of the first time, too
        write_prefix(files, prefix)
        assert (prefix / "lib/one/talk").readlink() == source / "bin/talk"
        assert (prefix / "share/one/top.launch").readlink() == source / "top.launch"
        assert not (prefix / "share/one/launch/top.launch").is_symlink()
        assert (prefix / "share/ament_index/resource_index/packages/one").read_text() == ""
        assert not (prefix / "share/one/.git").exists()


def test_folder_with_other_files_is_not_written_to(tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("x")
    with pytest.raises(UserError, match="holds other files, expected a new folder"):
        write_output(convert("/w"), tmp_path)
    assert [each.name for each in tmp_path.iterdir()] == ["mine"]


def test_file_in_the_place_of_the_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("x")
    with pytest.raises(UserError) as problem:
        write_output(convert("/w"), tmp_path / "taken/below")
    (found,) = problem.value.diagnostics
    assert "expected a folder to write to" in found.message
    assert found.help == "give another folder"
