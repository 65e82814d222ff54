"""What `ur new` writes, as text."""

import os
from pathlib import Path
from typing import Any

import pytest
import yaml

from ur.robot.base import read_base
from ur.source.diagnostic import UserError
from ur.tools.new.group import as_comment, plan_multi, plan_program
from ur.tools.new.node import plan_node
from ur.tools.new.package import write_base
from ur.tools.new.parts import (
    BaseRequest,
    IncludedPart,
    NewArgument,
    NewFile,
    NodeRequest,
    NodeTopic,
    Observed,
    write_files,
)


def test_topics_become_arguments_and_remaps() -> None:
    seen = Observed(
        (NodeTopic("scan", "sensor_msgs/LaserScan"), NodeTopic("~cost", published=True), NodeTopic("machine")),
        ("clear",),
    )
    (file,) = plan_node(NodeRequest("map", "maps", "mapper", "Make a map.", observed=seen), "mine")
    text = str(file.text)
    assert file.path == "n_map/launch/n_map.launch.xml"
    assert '<arg name="scan" default="scan"/>' in text
    assert "<!--scan: The topic that it subscribes as `scan` (`sensor_msgs/LaserScan`).-->" in text
    assert '<remap from="~cost" to="$(arg cost)"/>' in text
    assert '<remap from="machine" to="$(arg machine_topic)"/>' in text
    assert "<!--publishes: ~cost-->" in text
    assert "<!--subscribes: scan machine-->" in text
    assert "It offers `clear`." in text


def test_parameters_become_a_file_and_unset_ones_a_comment() -> None:
    seen = Observed(parameters={"rate": 5, "map/size": 2.5, "frame": None})
    launch, parameters = plan_node(NodeRequest("map", "maps", "mapper", "Make a map.", observed=seen), "mine")
    assert 'file="$(find mine)/n_map/params/map.yaml"' in str(launch.text)
    assert yaml.safe_load(parameters.text) == {"rate": 5, "map": {"size": 2.5}}
    assert "#   frame\n" in str(parameters.text)


def test_group_asks_for_what_its_parts_require_and_hands_it_on() -> None:
    parts = [
        IncludedPart(
            "$(find p)/n_a/launch/n_a.launch.xml",
            {"robot_base": None, "machine": "localhost", "gain": "1", "file": None},
        ),
        IncludedPart("$(find p)/rviz_b/launch/rviz_b.launch.xml", {"machine": "localhost"}),
        IncludedPart("$(find p)/n_c/launch/n_c.launch.xml", {"gain": "2"}),
    ]
    text = str(plan_multi("all", "All.", parts)[0].text)
    assert '<arg name="machine" value="$(arg robot_machine)"/>' in text
    assert '<arg name="machine" value="$(arg viewer_machine)"/>' in text
    assert '<arg name="file"/>' in text
    assert "gain" not in text
    assert '<include file="$(find p)/n_c/launch/n_c.launch.xml"/>' in text


def test_program_is_documented_and_executable() -> None:
    (file,) = plan_program("go", "Go there.", "p", "m_go.launch.xml")
    assert file.executable
    assert "##Summary: Go there.\n##Overview: Starts `m_go.launch.xml` on the selected robot.\n" in str(file.text)
    assert 'exec ur launch p m_go.launch.xml "$@"\n' in str(file.text)


@pytest.mark.parametrize("size", [0.05, 0.4, 2.0])
def test_base_of_any_size_is_a_valid_base(tmp_path: Path, size: float) -> None:
    request = BaseRequest(
        "dot",
        "A dot: small.",
        size,
        size,
        size / 2,
        size * 10,
        size / 8,
        size * 0.8,
        0.4,
        1.0,
        lidar=True,
        raspicam=True,
    )
    path = tmp_path / "base.yaml"
    path.write_text(write_base(request).replace("A dot: small", "A dot"))
    base = read_base(path, "dot")
    assert base.wheels.separation == pytest.approx(size * 0.8, rel=1e-3)
    assert base.lidar is not None
    assert base.raspicam is not None


@pytest.mark.parametrize(("text", "said"), [("a -- b ---> c-", "a - b -> c"), ("two\n lines", "two lines")])
def test_texts_cannot_end_a_comment(text: str, said: str) -> None:
    assert as_comment(text) == said


def test_arguments_with_odd_characters_are_escaped() -> None:
    from ur.tools.new.group import write_launch

    assert """default='say "hi" &amp; &lt;go&gt;'""" in write_launch(
        "s", "", [NewArgument("a", "d", 'say "hi" & <go>')], []
    )


def test_nothing_is_overwritten_and_nothing_is_left_behind(tmp_path: Path) -> None:
    (tmp_path / "there").write_text("mine")
    with pytest.raises(UserError, match="there is there already"):
        write_files(tmp_path, [NewFile("new/a", ""), NewFile("there", "")])
    assert [path.name for path in tmp_path.iterdir()] == ["there"]


def test_failure_in_the_middle_takes_everything_back(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError):
        write_files(tmp_path, [NewFile("new/a", ""), NewFile("file/b", "")])
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


class Killed(BaseException):
    """The process ends here: nothing is cleaned up."""


FILES = (
    NewFile("bases/r/base.yaml", "name: r\n"),
    NewFile("n_a/params/r.yaml", "a: 1\n"),
    NewFile("bin/ur_r", "#!", True),
)


def write_until(package: Path, calls: int, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Write FILES, and end after so many calls that change the disk as a kill does. Return whether it ended itself."""
    left = calls
    with monkeypatch.context() as patch:
        for name in ("open", "fsync", "replace", "rename", "mkdir"):
            real = getattr(os, name)

            def call(*words: Any, real: Any = real, **options: Any) -> Any:
                nonlocal left
                left -= 1
                if left < 0:
                    raise Killed
                return real(*words, **options)

            patch.setattr(os, name, call)
        patch.setattr(os, "unlink", lambda *_, **__: None)
        patch.setattr(os, "rmdir", lambda *_, **__: None)
        try:
            write_files(package, FILES)
        except Killed:
            return False
    return True


@pytest.mark.parametrize("new", [False, True])
def test_kill_at_any_moment_leaves_no_base_file_that_lacks_its_others_and_a_repeat_completes_them(
    new: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done, calls = False, 0
    while not done:
        package = tmp_path / str(calls)
        if not new:
            package.mkdir()
        done = write_until(package, calls, monkeypatch)
        calls += 1
        there = [each for each in FILES if (package / each.path).exists()]
        assert all((package / each.path).read_text() == each.text for each in there)
        if FILES[0] in there or (new and package.exists()):
            assert there == list(FILES)
            continue
        write_files(package, FILES)
        assert all((package / each.path).read_text() == each.text for each in FILES)
        assert os.access(package / "bin/ur_r", os.X_OK)
    assert calls > 10
    with pytest.raises(UserError, match="is there already"):
        write_files(package, FILES)
