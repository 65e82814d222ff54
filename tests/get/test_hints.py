"""Repositories that files of a folder name, and the table of those that no index has."""

import re

import pytest
from tests.base_contract import EVERY, load

from ur.get.hints import (
    find_hint,
    find_related_hint,
    load_sources,
    parse_sources,
    plain_address,
    read_hints,
    read_links,
)

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
    assert "pi_sonar" in table
    for package in told.keys() & table.keys():
        assert table[package].url.removesuffix(".git") in told[package]


def test_addresses_that_need_a_key_become_public_ones() -> None:
    urls = {
        "git clone git@github.com:me/lidar.git": "https://github.com/me/lidar.git",
        "git clone ssh://git@gitlab.com/me/lidar.git": "https://gitlab.com/me/lidar.git",
        "RUN git -C /ws/src clone --recursive 'http://github.com/me/lidar' && make": "https://github.com/me/lidar",
        "git submodule add -b main git@github.com:me/lidar.git": "https://github.com/me/lidar.git",
    }
    for text, url in urls.items():
        assert [each[1] for each in names("README.md", text)] == [url]
    listed = "- git: {local-name: lidar, uri: 'git@github.com:me/lidar.git', version: main}\n"
    assert names("a.rosinstall", listed) == [("lidar", "https://github.com/me/lidar.git", "main")]


@pytest.mark.parametrize(
    "text",
    [
        "git clone https://example.org/x$(reboot)y.git",
        "git clone -b $(reboot) https://example.org/x.git",
        "git clone file:///etc",
        "git clone ext::sh -c reboot",
        "git clone git@evil.example:me/lidar.git",
        "git clone https://example.org/../../x",
    ],
)
def test_command_of_another_form_names_nothing_that_a_shell_would_run(text: str) -> None:
    assert not [each for each in names("README.md", text) if set("$()`;|&<> ") & set("".join(each))]
    assert not [each for each in names("README.md", text) if not each[1].startswith("https://example.org/")]


def test_folder_that_a_repository_is_put_into_is_a_name_of_it() -> None:
    text = "git clone https://example.org/me/a.git src/lidar_driver"
    assert [each[0] for each in names("README.md", text)] == ["a", "lidar_driver"]


def test_submodules_have_their_branch_and_addresses_relative_to_the_owner() -> None:
    modules = """[submodule "x"]
\tpath = src/arm_driver
\turl = ../arm.git
\tbranch = noetic-devel
[submodule "y"]
\tpath = y
\turl = git@github.com:other/y.git
\tbranch = .
"""
    found = read_hints(".gitmodules", modules, "https://github.com/me")
    assert [(each.name, each.url, each.version) for each in found] == [
        ("arm", "https://github.com/me/arm.git", "noetic-devel"),
        ("arm_driver", "https://github.com/me/arm.git", "noetic-devel"),
        ("y", "https://github.com/other/y.git", ""),
    ]
    assert [each[0] for each in names(".gitmodules", modules)] == ["y"]


def test_links_name_repositories_once_with_the_branch() -> None:
    text = """<!--https://github.com/me/odom--> see [it](https://github.com/me/lidar/tree/melodic-devel), or
    https://github.com/me/lidar.git. https://github.com/me/lidar/blob/main/x.py http://gitlab.com/me/y/-/tree/noetic
    https://github.com/topics/ros https://example.org/me/no https://github.com/me"""
    assert [(each.name, each.url, each.version) for each in read_links(text)] == [
        ("odom", "https://github.com/me/odom", ""),
        ("lidar", "https://github.com/me/lidar", "melodic-devel"),
        ("y", "https://gitlab.com/me/y", "noetic"),
    ]


def test_common_word_is_no_name_of_a_repository_that_a_package_belongs_to() -> None:
    text = "git clone https://github.com/me/navigation\ngit clone https://github.com/me/gaden"
    hints = list(read_hints("README.md", text))
    assert find_related_hint("navigation_extra", hints) is None
    found = find_related_hint("gaden_player", hints)
    assert found is not None
    assert found.name == "gaden"


def test_repository_that_is_only_linked_to_has_related_packages_where_its_name_says_that_it_is_for_ros() -> None:
    text = "https://github.com/me/gaden https://github.com/me/tracer_ros https://github.com/me/verse_ros_package"
    links = list(read_links(text))
    assert find_related_hint("gaden_player", links) is None
    assert find_related_hint("tracer_base", links) is not None
    assert find_related_hint("verse_ros_bridge", links) is not None


@pytest.mark.parametrize(
    "url", ["git@github.com:Me/Lidar.git", "https://token@github.com/me/lidar/", "http://www.github.com/me/lidar.git"]
)
def test_addresses_of_one_repository_are_the_same(url: str) -> None:
    assert plain_address(url) == "github.com/me/lidar"
