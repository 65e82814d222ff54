import pytest

from ur.launchfile.address import join_addresses, resolve_addresses
from ur.launchfile.world.memory import MemoryWorld
from ur.source import UserError

WORLD = MemoryWorld(
    {
        "/p/launch/a.launch": "",
        "/p/one/b.launch": "",
        "/p/two/b.launch": "",
        "/p/m_drive/launch/m_drive.launch.xml": "",
        "/c.launch": "",
    },
    {"my_pkg": "/p"},
)


def test_package_and_name_give_the_file_anywhere_in_the_package() -> None:
    assert resolve_addresses(["my_pkg", "a.launch"], WORLD) == ["/p/launch/a.launch"]


def test_path_is_taken_as_it_is() -> None:
    assert resolve_addresses(["/c.launch"], WORLD) == ["/c.launch"]


@pytest.mark.parametrize(
    ("words", "message", "help_"),
    [
        (["my_pkg", "b.launch"], "has 2 files", "/p/one/b.launch"),
        (["my_pkg", "aa.launch"], "no file '", "a.launch"),
        (["my_pkg", "m_driv.launch.xml"], "no file '", "m_drive.launch.xml"),
        (["my_pgk", "a.launch"], "no package or file named", "my_pkg"),
        (["/cc.launch"], "no file '/cc.launch'", "/c.launch"),
        (
            ["my_pkg"],
            "no launch file given for package 'my_pkg', expected one of a.launch, b.launch",
            "ur launch my_pkg",
        ),
        (["my_pkg", "bb.launch"], "no file '", "did you mean b.launch?"),
    ],
)
def test_wrong_address_is_explained(words: list[str], message: str, help_: str) -> None:
    with pytest.raises(UserError) as caught:
        resolve_addresses(words, WORLD)
    found = caught.value.diagnostics[0]
    assert message in found.message
    assert help_ in (found.help or "")


def test_package_and_name_are_one_address_among_several() -> None:
    words = ["my_pkg", "a.launch", "my_pkg", "/c.launch", "nothing"]
    assert join_addresses(words, WORLD) == ["/p/launch/a.launch", "my_pkg", "/c.launch", "nothing"]


def test_package_and_name_of_several_files_is_explained() -> None:
    with pytest.raises(UserError) as caught:
        join_addresses(["my_pkg", "b.launch"], WORLD)
    assert caught.value.diagnostics[0].rule == "ambiguous-file"


def test_only_launch_files_are_suggested_for_a_path() -> None:
    world = MemoryWorld({"/home/.profile": "", "/home/nofile.txt": ""})
    with pytest.raises(UserError) as caught:
        resolve_addresses(["/home/nofile"], world)
    assert caught.value.diagnostics[0].help == "give a path, or a package and a file name"


def test_package_is_found_where_a_folder_of_its_name_lies_in_the_current_one() -> None:
    world = MemoryWorld({"/p/launch/a.launch": "", "my_pkg/package.xml": ""}, {"my_pkg": "/p"})
    assert join_addresses(["my_pkg", "a.launch"], world) == ["/p/launch/a.launch"]
    assert join_addresses(["my_pkg"], world) == ["my_pkg"]
