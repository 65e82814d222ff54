from __future__ import annotations

from pathlib import Path

import pytest

from ur.cli.main import main

BODY = """<launch>
  <arg name="what" doc="what it is about"/><arg name="how" default="well"/>
  <param name="number" value="3"/><param name="printed" command="echo 2.5"/>
  <node pkg="nodes" type="one" name="one" args="a 'b c'" ns="deep"><remap from="x" to="y"/></node>
  <node pkg="nodes" type="two" name="two"/>
</launch>"""


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "nodes"))
    monkeypatch.setenv("PATH", "/usr/bin:/bin")  # the verb changes it; this brings it back afterwards
    for name in ("UR_SELECTION", "ROS_MASTER_URI", "ROS_HOSTNAME"):
        monkeypatch.setenv(name, "")
    (tmp_path / "nodes").mkdir()
    (tmp_path / "nodes/package.xml").write_text("<package><name>nodes</name></package>")
    for name in ("one", "two"):
        (tmp_path / "nodes" / name).touch(0o755)
    path = tmp_path / "test.launch"
    path.write_text(BODY)
    return str(path)


@pytest.mark.parametrize(
    ("words", "printed"),
    [
        (["--nodes"], "/deep/one\n/two\n"),
        (["--files"], "{file}\n"),
        (["--find-node", "deep/one"], "{file}\n"),
        (["--args", "/deep/one"], 'ROS_NAMESPACE="/deep" {folder}/nodes/one a b c x:=y __name:=one\n'),
        (["--dump-params"], "/number: 3\n/printed: 2.5\n\n"),
        (
            ["--ros-args"],
            "Required Arguments:\n  what: what it is about\n"
            'Optional Arguments:\n  how (default "well"): undocumented\n',
        ),
    ],
)
def test_questions_are_answered_as_roslaunch_does(
    file: str, words: list[str], printed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["launch", *words, file, "what:=x"]) == 0
    assert capsys.readouterr().out == printed.format(file=file, folder=Path(file).parent)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--args", "/deep/onne"], "did you mean /deep/one?"),
        (["--only", "three"], "node 'three' is not in this launch file, expected one of /deep/one, /two"),
        (["--prefix", "two"], "--prefix 'two', expected NODE=PREFIX"),
        (["--screen", "--log"], "--screen and --log exclude each other"),
        (["--nodes", "--files"], "--nodes and --files exclude each other"),
        (["--core"], "--core is not for ur launch: ur starts a master with the first launch file"),
        (["-c", "child"], "-c is not for ur launch"),
    ],
)
def test_wrong_wishes_are_explained(file: str, words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", *words, file, "what:=x"]) == 2
    captured = capsys.readouterr()
    assert told in captured.err
    assert captured.out == ""
