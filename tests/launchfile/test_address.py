from __future__ import annotations

import pytest

from ur.launchfile import MemoryWorld, resolve_addresses
from ur.source import UserError

WORLD = MemoryWorld(
    {"/p/launch/a.launch": "", "/p/one/b.launch": "", "/p/two/b.launch": "", "/c.launch": ""}, {"my_pkg": "/p"}
)


def test_package_and_name_give_the_file_anywhere_in_the_package() -> None:
    assert resolve_addresses(["my_pkg", "a.launch", "x:=1"], WORLD) == ["/p/launch/a.launch"]


def test_path_is_taken_as_it_is() -> None:
    assert resolve_addresses(["/c.launch", "x:=1"], WORLD) == ["/c.launch"]


@pytest.mark.parametrize(
    ("words", "message", "help_"),
    [
        (["my_pkg", "b.launch"], "holds 2 files", "/p/one/b.launch"),
        (["my_pkg", "aa.launch"], "holds no file", "a.launch"),
        (["my_pgk", "a.launch"], "neither", "my_pkg"),
        (["/d.launch"], "is no file", "/c.launch"),
    ],
)
def test_wrong_address_is_explained(words: list[str], message: str, help_: str) -> None:
    with pytest.raises(UserError) as caught:
        resolve_addresses(words, WORLD)
    found = caught.value.diagnostics[0]
    assert message in found.message
    assert help_ in (found.help or "")
