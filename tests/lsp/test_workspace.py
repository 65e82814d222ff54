"""Texts of an editor and their findings, without the protocol."""

from pathlib import Path

import pytest
from tests.check.test_golden import INPUTS, THE_THIRTEEN, check
from tests.lsp import random_edits

from ur.check.worlds import make_world
from ur.launchfile.world.system import SystemWorld
from ur.lsp.workspace import Workspace, encode_text

TOP = """<launch>
  <arg name="a" default="1"/>
  <include file="$(dirname)/b.launch"><arg name="x" value="$(arg a)"/></include>
</launch>
"""
PART = '<launch>\n  <arg name="x"/>\n  <param name="p" value="$(arg x)"/>\n</launch>\n'


def rules_in(workspace: Workspace, path: str) -> list[str]:
    for _ in workspace.steps([path]):
        pass
    return [found.rule for found in workspace.findings_of(path)]


def open_workspace(folder: Path) -> tuple[Workspace, list[str]]:
    paths = random_edits.make_package(folder / "my_robot", [TOP, PART])
    return Workspace([str(folder / "my_robot")], lambda places: make_world(places, {})), paths


def test_random_edits_end_with_the_findings_of_a_new_check(tmp_path: Path) -> None:
    assert random_edits.run(tmp_path / "my_robot", [TOP, PART, TOP.replace("b.launch", "c.launch")], 150, 7, 30) == 5


def test_edit_of_an_included_file_changes_the_findings_of_the_including_one(tmp_path: Path) -> None:
    workspace, (top, part) = open_workspace(tmp_path)
    assert rules_in(workspace, top) == []
    workspace.set_text(part, PART.replace('name="x"', 'name="y"'))
    assert rules_in(workspace, top) == ["missing-argument", "unknown-argument"]
    workspace.drop_text(part)
    assert rules_in(workspace, top) == []


def test_file_that_is_not_stored_yet_is_checked(tmp_path: Path) -> None:
    workspace, (top, _) = open_workspace(tmp_path)
    new = top.replace("a.launch", "new.launch")
    workspace.set_text(new, '<launch><param name="p" value="$(arg q)"/></launch>')
    assert rules_in(workspace, new) == ["undeclared-argument"]
    workspace.drop_text(new)
    assert rules_in(workspace, new) == []


def test_file_outside_of_the_folders_is_checked_with_its_package(tmp_path: Path) -> None:
    workspace = Workspace([], lambda places: make_world(places, {}))
    _, part = random_edits.make_package(tmp_path / "other", [TOP, PART])
    assert rules_in(workspace, part) == []
    workspace.set_text(part, PART.replace("(arg x)", "(arg z)"))
    assert rules_in(workspace, part) == ["undeclared-argument"]


def test_text_is_encoded_as_it_declares() -> None:
    assert encode_text('<?xml version="1.0" encoding="latin-1"?><launch>ä</launch>').endswith(b"\xe4</launch>")
    assert encode_text("ä\ud800") == "ä?".encode()


@pytest.mark.parametrize("case", THE_THIRTEEN, ids=lambda case: case.name)
def test_ordinary_mistake_appears_while_it_is_typed(case: Path) -> None:
    environment = {"ROS_PACKAGE_PATH": str(INPUTS), "HOME": "/home/robot"}
    workspace = Workspace([str(case)], lambda _: SystemWorld(environment))
    path = str(case / "main.launch")
    text = Path(path).read_text(encoding="utf-8")
    for end in (*range(0, len(text), 16), len(text)):  # as it is typed, a few letters at a time
        workspace.set_text(path, text[:end])
        rules_in(workspace, path)
    found = {(each.rule, str(each.span)) for each in workspace.findings_of(path)}
    if not (case / "arguments.txt").exists():  # an editor gives none
        expected = {(each.rule, f"{case}/{each.span}") for each in check(case).findings}
        assert found == {each for each in expected if each[1].startswith(path)}
        assert expected
