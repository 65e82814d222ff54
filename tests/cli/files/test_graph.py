"""`ur graph` as it is typed."""

from pathlib import Path

import pytest
from tests.ros_session import free_port

from ur.cli.main import main

TOP = """<launch>
  <arg name="robot_base"/>
  <include file="$(dirname)/part_$(arg robot_base).launch.xml"/>
  <node name="view" pkg="p" type="image_view"><remap from="image" to="camera"/></node>
</launch>
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    (tmp_path / "top.launch").write_text(TOP)
    (tmp_path / "part_stage.launch.xml").write_text("<launch><node name='n' pkg='p' type='t'/></launch>")
    return tmp_path


def test_graph_draws_the_tree_for_the_selected_base(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["graph", "top.launch"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "top.launch",
        "├─ part_stage.launch.xml",
        "│  └─ /n  p/t",
        "└─ /view  p/image_view",
    ]


def test_missing_file_is_drawn_and_explained(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["graph", "top.launch", "robot_base:=magni"]) == 1
    told = capsys.readouterr()
    assert "├─ part_magni.launch.xml  no such file:" in told.out
    assert "top.launch:3:" in told.err


def test_topics_are_drawn_without_starting_anything(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["graph", "--topics", "top.launch"]) == 0
    assert "  ← /camera" in capsys.readouterr().out


@pytest.mark.parametrize(("name", "begin"), [("a.svg", "<svg"), ("a.txt", "top.launch")])
def test_name_of_the_output_says_its_form(folder: Path, name: str, begin: str) -> None:
    assert main(["graph", "top.launch", "-o", name]) == 0
    assert (folder / name).read_text().startswith(begin)


def test_live_graph_without_a_master_says_so(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    port = free_port()
    monkeypatch.setenv("ROS_MASTER_URI", f"http://localhost:{port}")
    assert main(["graph", "--live"]) == 2
    assert f"no master answers at http://localhost:{port}" in capsys.readouterr().err


def test_nothing_to_draw_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["graph"]) == 2
    assert "expected a launch file, or --live" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["x.png", "x.PDF"])
def test_picture_that_is_no_svg_is_refused_before_a_file_is_written(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.launch"
    path.write_text("<launch/>", encoding="utf-8")
    assert main(["graph", str(path), "-o", str(tmp_path / name)]) == 2
    assert f"help: -o {tmp_path / 'x.svg'}" in capsys.readouterr().err
    assert not (tmp_path / name).exists()
