"""A check that recalls findings says what one says that finds everything again, whatever was edited between them."""

import os
import re
import shutil
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from ur.check.cache.recall import Recall
from ur.check.render.text import render_json
from ur.check.session import check_paths
from ur.check.worlds import make_world
from ur.launchfile.world import MemoryWorld

ROOT = Path(__file__).resolve().parents[3]
DRIVERS = """<launch>
  <arg name="robot"/>
  <arg name="rate" default="$(optenv RATE 10)"/>
  <node name="base" pkg="one" type="run" ns="$(arg robot)">
    <rosparam file="$(find two)/params/base.yaml"/>
    <param name="rate" type="double" value="$(arg rate)"/>
  </node>
</launch>
"""
TASK = """<launch>
  <arg name="robot" default="a"/>
  <arg name="camera" default="false"/>
  <include file="$(find one)/launch/drivers.launch">
    <arg name="robot" value="$(arg robot)"/>
  </include>
  <node name="planner" pkg="two" type="plan" if="$(arg camera)"/>
  <include file="beside.launch"/>
</launch>
"""
FILES = {
    "/w/one/package.xml": "<package><name>one</name><depend>two</depend></package>",
    "/w/one/launch/drivers.launch": DRIVERS,
    "/w/one/scripts/run": "#!/bin/sh\n",
    "/w/two/package.xml": "<package><name>two</name></package>",
    "/w/two/launch/task.launch": TASK,
    "/w/two/launch/beside.launch": '<launch><arg name="unused" default="ä"/></launch>',
    "/w/two/params/base.yaml": "gain: 1\n",
    "/w/two/scripts/plan": "#!/bin/sh\n",
}
_PATHS = sorted(FILES)
_OTHERS = ("/w/two/launch/new.launch", "/w/one/CMakeLists.txt", "/w/one/bases/magni/base.yaml", "/w/three/package.xml")
_TEXTS = (
    *(DRIVERS, TASK, "", "gain: [", "<launch/>", "<launch>", "add_executable(run x.cpp)", "<package><name>tow</name>"),
    '<launch><node name="n" pkg="tow" type="x"/><include file="$(find one)/launch/drivers.launch"/></launch>',
    '<launch><!--ur: ignore unknown-package: later--><node name="n" pkg="three" type="run"/></launch>',
)
_PIECES = (
    *(("one", "tow"), ("run", "rnu"), ("robot", "robto"), ("default=", "value="), ("false", "true")),
    ("if=", "unless="),
    *(("</launch>", '<param name="x" value="$(arg robot)"/></launch>'), ("</launch>", '<bad pkg="q"/></launch>')),
)
EDITS = st.one_of(
    st.tuples(st.just("write"), st.sampled_from((*_PATHS, *_OTHERS)), st.sampled_from(_TEXTS)),
    st.tuples(st.just("replace"), st.sampled_from(_PATHS), st.sampled_from(_PIECES)),
    st.tuples(st.just("remove"), st.sampled_from(_PATHS), st.none()),
    st.tuples(st.just("variable"), st.just("RATE"), st.sampled_from((None, "5", "fast"))),
    st.tuples(st.just("executable"), st.sampled_from(("/w/one/scripts/run", "/w/two/scripts/plan")), st.none()),
)


class ChangingWorld(MemoryWorld):
    """A world whose files may become those of another one."""

    def become(self, other: MemoryWorld) -> None:
        self.__dict__.update(other.__dict__)


class Workspace:
    def __init__(self) -> None:
        self.files: dict[str, str] = dict(FILES)
        self.environment: dict[str, str] = {}
        self.executables = {"/w/one/scripts/run", "/w/two/scripts/plan"}

    def edit(self, kind: str, name: str, what: object) -> None:
        if kind == "write":
            self.files[name] = str(what)
        elif kind == "replace" and name in self.files:
            assert isinstance(what, tuple)
            self.files[name] = self.files[name].replace(*what)
        elif kind == "remove":
            self.files.pop(name, None)
        elif kind == "variable":
            self.environment.pop(name, None)
            self.environment.update({name: str(what)} if what else {})
        elif kind == "executable":
            self.executables ^= {name}

    def world(self) -> ChangingWorld:
        found = re.compile(r"<name>(\w+)</name>")
        packages = {
            match.group(1): path.removesuffix("/package.xml")
            for path, text in self.files.items()
            if path.endswith("/package.xml") and (match := found.search(text))
        }
        return ChangingWorld(self.files, packages, self.environment, self.executables & set(self.files))

    def check(self, recall: Recall | None = None) -> str:
        return render_json(check_paths(["/w"], self.world(), recall=recall))


@settings(max_examples=60, deadline=None)
@given(st.lists(EDITS, min_size=1, max_size=5))
def test_recalled_findings_are_those_found_again_after_any_edit(edits: list[tuple[str, str, object]]) -> None:
    workspace = Workspace()
    recall = Recall()
    workspace.check(recall)
    for edit in edits:
        workspace.edit(*edit)
        recall = Recall(recall.now)
        assert workspace.check(recall) == workspace.check()


def test_only_the_files_that_an_edit_concerns_are_checked_again() -> None:
    workspace = Workspace()
    first = Recall()
    workspace.check(first)
    again = Recall(first.now)
    workspace.check(again)
    assert (again.recalled, again.changed) == (4, False)
    workspace.edit("replace", "/w/two/launch/beside.launch", ("unused", "used"))
    edited = Recall(first.now)
    workspace.check(edited)
    assert edited.recalled == 2  # drivers.launch and the YAML file; task.launch includes what was edited
    assert edited.changed


def test_file_that_is_gone_is_forgotten() -> None:
    workspace = Workspace()
    first = Recall()
    workspace.check(first)
    workspace.edit("remove", "/w/two/launch/beside.launch", None)
    again = Recall(first.now)
    workspace.check(again)
    assert again.forgets
    launch_files = {"/w/one/launch/drivers.launch", "/w/two/launch/task.launch"}
    assert set(again.now.units) == launch_files | {"/w/two/params/base.yaml"}


def test_other_arguments_are_other_findings() -> None:
    workspace = Workspace()
    world = MemoryWorld(workspace.files, {"one": "/w/one", "two": "/w/two"}, {}, workspace.executables)
    first = Recall()
    check_paths(["/w"], world, arguments={"rate": "5"}, recall=first)
    again = Recall(first.now)
    report = check_paths(["/w"], world, arguments={"rate": "fast"}, recall=again)
    assert "bad-param-value" in {found.rule for found in report.findings}
    assert again.recalled == 3


def test_library_gives_the_same_findings_with_and_without(tmp_path: Path) -> None:
    package = tmp_path / "ubiquity_launches"
    shutil.copytree(ROOT / "ubiquity_launches", package, symlinks=True)
    environment = {**os.environ, "ROS_PACKAGE_PATH": str(tmp_path)}

    def check(recall: Recall | None = None) -> str:
        return render_json(check_paths([str(package)], make_world([str(package)], environment), recall=recall))

    recall = Recall()
    check(recall)
    edited = package / "m_robot_base" / "launch" / "m_robot_base.launch.xml"
    edited.write_text(edited.read_text().replace("robot_variant", "robot_vairant", 1).replace("find ", "fnid ", 1))
    (package / "package.xml").write_text((package / "package.xml").read_text().replace("rviz", "riviz"))
    recall = Recall(recall.now)
    expected = check()
    assert check(recall) == expected
    again = Recall(recall.now)
    assert check(again) == expected
    assert again.recalled == len(again.now.units) > 20
