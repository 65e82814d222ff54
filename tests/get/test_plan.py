"""Plans of `ur get`, from tables in memory."""

import re
from collections.abc import Sequence

import pytest
from tests.base_contract import EVERY, load

from ur.get.computer import load_tables
from ur.get.index import load_sources, merge_indexes, parse_index, parse_sources, read_dependencies
from ur.get.missing import named_packages
from ur.get.plan import Tables, make_plan, render_plan
from ur.get.steps import DebianPackage, Missing, parse_candidates, parse_table

INDEX = """\
repositories:
  navigation:
    release: {packages: [amcl, move_base]}
    source: {type: git, url: 'https://example.org/navigation.git', version: noetic-devel}
  evil:
    source: {type: git, url: 'https://example.org/x;rm -rf ~', version: main}
  evil_version:
    source: {type: git, url: 'https://example.org/x.git', version: '--upload-pack=x'}
"""
APT = """\
Package: rviz
Maintainer: Debian Science Maintainers
Homepage: https://wiki.ros.org/rviz
Filename: pool/r.deb

Package: joy
Maintainer: Somebody
Homepage: https://example.org/game
Filename: pool/j.deb
"""


def plan(*names: str, **tables: object) -> dict[str, tuple[str, tuple[str, ...]]]:
    given = Tables(**{"rosdep": {}, "candidates": {}, **tables})  # type: ignore[arg-type]
    steps = make_plan([Missing(name) for name in names], given, lambda name: name == "roscpp").steps
    return {step.missing.package: (step.method, step.names) for step in steps}


def test_package_of_the_release_comes_from_it_and_one_that_only_has_its_name_does_not() -> None:
    candidates = parse_candidates(APT)
    assert plan("rviz", "joy", candidates=candidates) == {"rviz": ("debian", ("rviz",)), "joy": ("unknown", ())}


def test_table_of_rosdep_is_used_where_apt_has_all_of_its_names() -> None:
    table = parse_table("urdf:\n  debian: [liburdf-dev]\nhalf:\n  debian: [a-b, c-d]\nbad:\n  debian: ['; rm']\n")
    assert "bad" not in table
    candidates = {name: DebianPackage(name, for_ros=False) for name in ("liburdf-dev", "a-b")}
    found = plan("urdf", "half", rosdep=table, candidates=candidates)
    assert found == {"urdf": ("debian", ("liburdf-dev",)), "half": ("unknown", ())}
    assert plan("urdf", rosdep=table, candidates=None) == {"urdf": ("debian", ("liburdf-dev",))}


def test_xacro_comes_from_pypi_where_no_release_has_it() -> None:
    assert plan("xacro") == {"xacro": ("pypi", ("xacro",))}
    ros = {"ros-noetic-xacro": DebianPackage("ros-noetic-xacro", for_ros=True)}
    assert plan("xacro", candidates=ros, distribution="noetic") == {"xacro": ("debian", ("ros-noetic-xacro",))}


def test_source_is_named_with_commands_and_hostile_addresses_are_not() -> None:
    index = parse_index(INDEX)
    assert sorted(index.repositories) == ["amcl", "move_base"]
    steps = make_plan([Missing("amcl"), Missing("move_base")], Tables({}, {}, index=index), lambda _: False)
    text = render_plan(steps)
    assert text.count("git clone -b noetic-devel https://example.org/navigation.git ~/catkin_ws/src/navigation") == 1
    assert text.endswith("  cd ~/catkin_ws && catkin_make\n")


def test_dependencies_that_are_missing_too_are_named() -> None:
    xml = "<package><name>amcl</name><depend>roscpp</depend><exec_depend>tf2</exec_depend></package>"
    index = parse_index(f"{INDEX}release_package_xmls:\n  amcl: '{xml}'\n")
    steps = make_plan([Missing("amcl")], Tables({}, {}, index=index), lambda name: name == "roscpp").steps
    assert steps[0].needs == ("tf2",)


def test_older_distribution_counts_only_where_no_newer_one_has_the_package() -> None:
    old = parse_index(INDEX.replace("[amcl", "[amcl, fake_loc"), "kinetic")
    both = merge_indexes([parse_index(INDEX), old])
    assert (both.repositories["amcl"].distribution, both.repositories["fake_loc"].distribution) == ("", "kinetic")


@pytest.mark.parametrize("text", ["", "[1, 2]", "a: {", "repositories: 3", "- " * 3000 + "x"])
def test_damaged_index_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"YAML|mapping|repositories"):
        parse_index(text)


def test_package_xml_with_entities_is_refused() -> None:
    with pytest.raises(ValueError, match="document type"):
        read_dependencies('<!DOCTYPE a [<!ENTITY b "c">]><package/>')


@pytest.mark.parametrize(
    ("condition", "counts"),
    [
        ("$ROS_VERSION == 1", True),
        ("$ROS_VERSION == 2", False),
        ("$ROS_DISTRO >= melodic and $ROS_PYTHON_VERSION == '3'", True),
        ("$ROS_VERSION != 1 or ($OTHER == '' and $ROS_VERSION < 2)", True),
        ("($ROS_VERSION == 2 or $OTHER == x) and $ROS_VERSION == 1", False),
        ("no condition", True),
    ],
)
def test_dependency_counts_where_its_condition_holds(condition: str, counts: bool) -> None:
    for tag in ("depend", "exec_depend", "run_depend", "build_depend"):
        text = f'<package format="3"><{tag} condition="{condition.replace("<", "&lt;")}">tf2</{tag}></package>'
        assert read_dependencies(text) == (("tf2",) if counts else ())


def test_condition_is_one_of_the_sourced_ros() -> None:
    text = '<package><depend condition="$ROS_VERSION == 2">tf2</depend></package>'
    assert read_dependencies(text, {"ROS_VERSION": "2"}) == ("tf2",)


def test_launch_file_names_packages_outside_of_comments() -> None:
    text = """<launch><!-- $(find old) --><node name="a" type="b" pkg="one"/><param command="$(find xacro)/xacro"/>
    <include file="$(eval find('two') + '/x')"/><node pkg="$(arg pkg)" name="c" type="d"/></launch>"""
    assert named_packages(text) == {"one", "xacro", "two"}


class Nothing:
    """A computer without any table."""

    def read_rosdep(self) -> tuple[str, str]:
        return "", "no table"

    def read_indexes(self, _names: Sequence[str]) -> tuple[tuple[tuple[str, str], ...], str]:
        return (), "no index"

    def show_candidates(self, _names: Sequence[str]) -> None:
        return None

    def list_installed(self, _names: Sequence[str]) -> frozenset[str]:
        return frozenset()


def test_missing_tables_are_reported_and_what_needs_none_is_still_planned() -> None:
    missing = [Missing("amcl"), Missing("xacro")]
    tables, notes = load_tables(missing, Nothing())
    made = make_plan(missing, tables, lambda _: False, notes)
    assert made.notes == ("no table", "no index")
    assert [step.method for step in made.steps] == ["unknown", "pypi"]
    assert "note: no index\n" in render_plan(made)


def test_repository_without_source_is_replaced_by_that_of_its_releases() -> None:
    index = parse_index("""\
repositories:
  sim:
    release:
      packages: [sim_gazebo]
      tags: {release: 'release/indigo/{package}/{version}'}
      url: https://example.org/sim-release.git
      version: 1.2.0-0
""")
    found = index.repositories["sim_gazebo"]
    assert (found.url, found.version, found.distribution) == (
        "https://example.org/sim-release.git", "release/indigo/sim_gazebo/1.2.0-0", "indigo",
    )  # fmt: skip


def test_sources_are_asked_in_order_index_then_table_then_ros_2() -> None:
    old = parse_index(INDEX)
    newer = parse_index(INDEX.replace("[amcl", "[tracker, only_new, amcl"), "humble")
    tables = Tables({}, {}, index=old, known={"tracker": old.repositories["amcl"]}, ros2=newer)
    made = make_plan([Missing(name) for name in ("amcl", "tracker", "only_new")], tables, bool)
    assert {step.missing.package: step.reason for step in made.steps} == {
        "amcl": "",
        "tracker": "no index has it",
        "only_new": "only in ROS 2 humble, and has to be ported to ROS 1",
    }
    assert "only_new: https://example.org/navigation.git; only in ROS 2 humble" in render_plan(made)


def test_misspelt_package_gets_a_suggestion_and_a_private_one_the_file_that_names_it() -> None:
    tables = Tables({}, {}, index=parse_index(INDEX), names=frozenset({"my_robot_bringup"}))
    missing = [Missing("my_robot_bringpu", named_in="a.launch"), Missing("secret", named_in="demo/b.launch")]
    reasons = [step.reason for step in make_plan(missing, tables, bool).steps]
    assert reasons[0] == "no package has this name, which a.launch names; did you mean my_robot_bringup?"
    assert "which demo/b.launch names: it is private or withdrawn, ask its author" in reasons[1]


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
