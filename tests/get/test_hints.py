"""Repositories that files of a folder name, and the table of those that no index has."""

from __future__ import annotations

import re

import pytest
from tests.base_contract import EVERY, load

from ur.get.hints import find_hint, find_related_hint, load_sources, parse_sources, read_hints

WSTOOL = """\
- git:
    local-name: arms/denso_cobotta_ros
    uri: https://example.org/denso_cobotta_ros
    version: noetic-devel
- git: {local-name: evil, uri: 'https://example.org/x;rm -rf ~'}
- 3
"""
VCSTOOL = """\
repositories:
  src/tracker: {type: git, url: 'https://example.org/Tracker.git', version: main}
  broken: 7
"""


def names(file: str, text: str) -> list[tuple[str, str, str]]:
    return [(each.name, each.url, each.version) for each in read_hints(file, text)]


def test_lists_of_workspaces_are_read_and_hostile_entries_left_out() -> None:
    cobotta = ("denso_cobotta_ros", "https://example.org/denso_cobotta_ros", "noetic-devel")
    assert names("my.rosinstall", WSTOOL) == [cobotta]
    assert names(".travis.rosinstall.noetic", WSTOOL) == [cobotta]
    assert names("all.repos", VCSTOOL) == [("tracker", "https://example.org/Tracker.git", "main")]
    assert not names("all.repos", "a: {")
    modules = '[submodule "a"]\n\tpath = a\n\turl = https://example.org/interfaces.git\n'
    assert names(".gitmodules", modules) == [("interfaces", "https://example.org/interfaces.git", "")]


def test_commands_in_documents_name_repositories_with_their_branch() -> None:
    text = "Run `git clone --depth 1 -b melodic https://example.org/me/lidar_driver.git`,\ngit clone https://example.org/two."
    assert names("README.md", text) == [
        ("lidar_driver", "https://example.org/me/lidar_driver.git", "melodic"),
        ("two", "https://example.org/two", ""),
    ]
    assert not names("notes.txt", text)


@pytest.mark.parametrize(
    ("package", "found"),
    [
        ("denso_cobotta_ros", "denso_cobotta_ros"),
        ("denso_cobotta", "denso_cobotta_ros"),
        ("denso_cobotta_driver", "denso_cobotta_ros"),
        ("denso_arm", None),
        ("cobotta", None),
    ],
)
def test_package_is_found_by_the_name_of_its_repository(package: str, found: str | None) -> None:
    hints = list(read_hints("my.rosinstall", WSTOOL))
    hint = find_hint(package, hints) or find_related_hint(package, hints)
    assert (hint and hint.name) == found


def test_short_stem_is_no_hint() -> None:
    assert (
        find_hint("my_map", list(read_hints("a.repos", "repositories: {my_ros: {type: git, url: 'https://a.org/b'}}")))
        is None
    )


def test_table_of_sources_holds_addresses_that_a_shell_leaves_alone() -> None:
    table = load_sources()
    assert table["ydlidar"].url.startswith("https://")
    with pytest.raises(ValueError, match=r"known_sources\.tsv:2"):
        parse_sources("repository\tbranch\tpackages\nhttps://a.org/x;y\t-\tpkg\n")


def test_drivers_of_our_bases_that_no_index_has_come_from_where_their_base_files_say() -> None:
    drivers = [
        driver
        for name, variant in EVERY
        for driver in (load(name, variant).driver, *load(name, variant).drivers)
        if driver is not None
    ]
    told = {driver.package: re.findall(r"https://\S+", driver.install) for driver in drivers}
    table = load_sources()
    assert {"neato_node", "pi_sonar"} <= told.keys() & table.keys()
    for package in told.keys() & table.keys():
        assert table[package].url.removesuffix(".git") in told[package]
