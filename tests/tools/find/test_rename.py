"""Another name for an argument: everywhere, or not at all."""

from pathlib import Path

import pytest

from ur.check.session import CheckSession
from ur.check.worlds import make_world
from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import UserError
from ur.source.file import SourceFile
from ur.tools.find.arguments import apply_rename, rename_argument

ROOT = Path(__file__).parents[3]
TOP = """<launch>
  <arg name="speed" default="1"/>
  <!--speed: How fast.-->
  <include file="$(find one)/launch/part.launch"><arg name="speed" value="$(eval speed * 2)"/></include>
  <include file="$(find one)/launch/all.launch" pass_all_args="true"/>
</launch>
"""
PART = '<launch><arg name="speed"/><param name="speed" value="$(arg speed)"/></launch>'
FILES = {
    "/w/one/package.xml": "<package><name>one</name></package>",
    "/w/one/launch/top.launch": TOP,
    "/w/one/launch/part.launch": PART,
    "/w/one/launch/all.launch": PART,
}
PROGRAM = SourceFile("/w/one/bin/go", "#!/bin/sh\nexec roslaunch one top.launch speed:=3\n")


def session_of(files: dict[str, str]) -> CheckSession:
    session = CheckSession(["/w"], MemoryWorld(files, {"one": "/w/one"}))
    next(session.steps())
    return session


def rename(files: dict[str, str], name: str, old: str, new: str) -> dict[str, str]:
    session = session_of(files)
    views = session.sources.views
    return apply_rename(rename_argument(f"/w/one/launch/{name}", old, new, views, session.world, [PROGRAM]), new)


def test_argument_of_an_included_file_is_renamed_where_it_is_passed() -> None:
    texts = rename(FILES, "part.launch", "speed", "velocity")
    assert sorted(texts) == ["/w/one/launch/part.launch", "/w/one/launch/top.launch"]
    assert '<param name="speed" value="$(arg velocity)"/>' in texts["/w/one/launch/part.launch"]
    assert '<arg name="velocity" value="$(eval speed * 2)"/>' in texts["/w/one/launch/top.launch"]


def test_argument_is_renamed_through_pass_all_args_in_comments_and_programs() -> None:
    texts = rename(FILES, "top.launch", "speed", "velocity")
    assert sorted(texts) == ["/w/one/bin/go", "/w/one/launch/all.launch", "/w/one/launch/top.launch"]
    assert "velocity:=3" in texts["/w/one/bin/go"]
    assert "<!--velocity: How fast.-->" in texts["/w/one/launch/top.launch"]
    assert '<arg name="speed" value="$(eval velocity * 2)"/>' in texts["/w/one/launch/top.launch"]


@pytest.mark.parametrize("new", ["1st", "a b", "", "other"])
def test_name_that_is_none_or_taken_is_refused(new: str) -> None:
    files = {**FILES, "/w/one/launch/part.launch": PART.replace("<param", '<arg name="other" default=""/><param')}
    with pytest.raises(UserError):
        rename(files, "part.launch", "speed", new)


def test_rename_that_would_change_a_plan_is_refused() -> None:
    # pass_all_args hands on an argument of another meaning as soon as it has the name that is declared there.
    files = {**FILES, "/w/one/launch/all.launch": PART.replace("speed", "rate").replace("/>", ' default="5"/>', 1)}
    with pytest.raises(UserError, match="would mean something else"):
        rename(files, "top.launch", "speed", "rate")


def test_rename_in_the_library_keeps_every_plan() -> None:
    package = str(ROOT / "ubiquity_launches")
    session = CheckSession([package], make_world([package], {}))
    next(session.steps())
    views = session.sources.views
    path = f"{package}/m_keyboard_drive/launch/m_keyboard_drive.launch.xml"
    name = next(each for each in views[path].declared if each not in ("robot_base", "robot_variant"))
    spans = rename_argument(path, name, f"{name}_renamed", views, session.world)
    assert path in {span.file.path for span in spans}
