"""A repository in which the includes depend on the base: what documents say is what roslaunch itself resolves."""

import importlib.util
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.docs.helpers import ROVER, document_folder, find, walk
from tests.launchfile.conftest import BASE_ENVIRONMENT, Reference

from ur.docs.documents import BaseCase, Documents, TreeItem
from ur.docs.markdown.page import render_markdown

CASES = [BaseCase("loki"), BaseCase("magni"), BaseCase("magni", "lidar"), BaseCase("magni", "arm"), BaseCase("stage")]
ROOTS = ["launch/rover.launch", "m_rover/launch/m_rover.launch.xml"]
HAS_ROSLAUNCH = Path("/usr/lib/python3/dist-packages/roslaunch").is_dir() or importlib.util.find_spec("roslaunch")


@pytest.fixture(scope="module")
def documents() -> Documents:
    return document_folder(ROVER)


@pytest.fixture(scope="module")
def roslaunch() -> Iterator[Reference]:
    if not HAS_ROSLAUNCH:
        pytest.skip("roslaunch is not installed")
    reference = Reference()
    yield reference
    reference.close()


def by_default(item: TreeItem) -> Iterator[TreeItem]:
    # What starts without anything being asked for.
    if item.kind != "off" and not item.note.startswith("only with"):
        yield item
        for child in item.children:
            yield from by_default(child)


@pytest.mark.parametrize("path", ROOTS)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.label)
def test_tree_of_each_base_is_what_roslaunch_loads(
    path: str, case: BaseCase, documents: Documents, roslaunch: Reference
) -> None:
    # rover.launch hands on all that it declares, and it declares no variant.
    shown = case if "m_rover" in path else BaseCase(case.base)
    (tree,) = [tree for tree in find(documents, path).trees if shown in tree.cases]
    arguments = [f"robot_base:={shown.base}"] + [f"robot_variant:={shown.variant}"] * bool(shown.variant)
    environment = {**BASE_ENVIRONMENT, "ROS_PACKAGE_PATH": str(ROVER.parent)}
    loaded = roslaunch.load([str(ROVER / path)], arguments, environment)
    assert loaded["ok"], loaded
    started = list(by_default(tree.root))
    files = sorted({os.path.join(ROVER, item.path) for item in started if item.kind == "file"})  # noqa: PTH118
    assert files == loaded["files"]
    assert sorted("/" + item.name for item in started if item.kind == "node") == [n["name"] for n in loaded["nodes"]]


def test_what_options_turn_on_is_shown_with_the_options(documents: Documents, roslaunch: Reference) -> None:
    doc = find(documents, "m_rover/launch/m_rover.launch.xml")
    environment = {**BASE_ENVIRONMENT, "ROS_PACKAGE_PATH": str(ROVER.parent)}
    loaded = roslaunch.load([str(ROVER / doc.path)], ["robot_base:=loki", "camera:=true", "extras:=most"], environment)
    (tree,) = [tree for tree in doc.trees if BaseCase("loki") in tree.cases]
    names = {"/" + item.name for item in walk(tree.root) if item.kind == "node"}
    assert {node["name"] for node in loaded["nodes"]} < names
    notes = {item.name: item.note for item in walk(tree.root)}
    assert notes["n_camera.launch.xml"] == "only with `camera:=true`"
    assert notes["n_arm.launch.xml"] == "only with `extras:=all`"
    assert notes["$(find somewhere_else)/launch/other.launch"] == "only with `extras:=all`"


def test_every_include_tag_leads_to_a_file_under_the_bases_that_it_is_for(documents: Documents) -> None:
    doc = find(documents, "m_rover/launch/m_rover.launch.xml")
    targets = {
        (target.path or target.name): {case.label for case in target.cases}
        for include in doc.includes
        for target in include.targets
    }
    assert targets["m_rover/launch/drivers_loki.launch.xml"] == {"loki"}
    assert targets["m_rover/launch/magni/extra.launch.xml"] == {"magni", "magni (lidar)", "magni (arm)"}
    assert targets["n_arm/launch/n_arm.launch.xml"] == {"magni (arm)"}
    assert targets["m_extras/launch/m_extras.launch.xml"] == {"loki", "magni", "magni (lidar)", "magni (arm)"}
    assert "$(find somewhere_else)/launch/other.launch" in targets
    assert len(doc.includes) == (ROVER / doc.path).read_text().count("<include ")


def test_page_shows_every_include_below_its_base(documents: Documents) -> None:
    page = render_markdown(documents)
    program = page[page.index("### ur_rover") : page.index("## Launch directories")]
    parts = {part.splitlines()[0]: part for part in program.split("**On ")[1:]}
    assert list(parts) == ["loki**", "magni**", "magni (lidar)**", "magni (arm)**", "stage**"]
    for base in ("loki", "magni", "stage"):
        assert f"[drivers_{base}.launch.xml](#drivers_{base}launchxml)" in parts[f"{base}**"]
    assert "`top/arm`" in parts["magni (arm)**"]
    assert "`front/lidar`" in parts["stage**"]


def test_file_that_lacks_something_for_a_base_says_what(documents: Documents) -> None:
    doc = find(documents, "n_sonar/launch/n_sonar.launch.xml")
    missing = {each.case.label: each.missing for each in doc.support}
    assert missing["loki"] == missing["magni"] == ()
    assert "n_sonar/params/stage.yaml: no such file" in missing["stage"][0]


def test_need_that_no_variant_meets_is_missing(documents: Documents) -> None:
    doc = find(documents, "n_lidar/launch/n_lidar.launch.xml")
    assert doc.needs == ("lidar",)
    assert [(each.case.base, each.missing) for each in doc.support] == [
        ("loki", ("needs lidar",)),
        ("magni", ()),
        ("stage", ("needs lidar",)),
    ]


def test_bases_are_found_in_file_names_where_no_folder_names_them(tmp_path: Path) -> None:
    folder = tmp_path / "plain"
    for source in ROVER.rglob("*"):
        if source.is_file() and "bases" not in source.parts and source.name != "package.xml":
            target = folder / source.relative_to(ROVER)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(source.read_text().replace("$(find rover_launches)", "$(dirname)/../.."))
    documents = document_folder(folder)
    doc = find(documents, "m_rover/launch/m_rover.launch.xml")
    assert sorted({case.base for tree in doc.trees for case in tree.cases}) == ["loki", "magni", "stage"]
    assert not documents.packages[0].is_package
