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
        (["--screen", "--log"], "--screen and --log cannot be used together"),
        (["--nodes", "--ros-args"], "--nodes and --ros-args cannot be used together"),
        (["--files", "--dry-run"], "--files and --dry-run cannot be used together"),
        (["--core"], "--core starts a master alone"),
        (["-", "-"], "expected it once"),
        (["-c", "child"], "-c is not for ur launch"),
    ],
)
def test_wrong_options_are_explained(
    file: str, words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["launch", *words, file, "what:=x"]) == 2
    captured = capsys.readouterr()
    assert told in captured.err
    assert captured.out == ""


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--args", "/deep/onne"], "did you mean /deep/one?"),
        (["--dry-run", "--only", "three"], "unknown node 'three', expected one of /deep/one, /two"),
        (["--dry-run", "--prefix", "two"], "--prefix 'two', expected NODE=PREFIX"),
        (["--dry-run", "--required"], "--required: /two is to be respawned"),
    ],
)
def test_wrong_names_end_as_errors_in_the_file_do(
    file: str, words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = Path(file)
    path.write_text(path.read_text().replace('name="two"', 'name="two" respawn="true"'))
    assert main(["launch", *words, file, "what:=x"]) == 1
    captured = capsys.readouterr()
    assert told in captured.err
    assert captured.out == ""


def test_file_that_is_missing_ends_with_1(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", file + "x"]) == 1
    assert "test.launchx" in capsys.readouterr().err


def test_no_file_at_all_is_a_wrong_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch"]) == 2
    assert "missing argument" in capsys.readouterr().err


@pytest.mark.usefixtures("capsys")
@pytest.mark.parametrize(("given", "option"), [("--node", "--nodes"), ("--find=/two", "--find-node=/two")])
def test_option_may_be_cut_short_as_for_roslaunch(
    file: str, given: str, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["launch", option, file, "what:=x"]) == 0
    expected = capsys.readouterr().out
    assert main(["launch", given, file, "what:=x"]) == 0
    assert capsys.readouterr().out == expected


def test_several_questions_are_answered_in_the_order_of_roslaunch(
    file: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["launch", "--nodes", "--files", file, "what:=x"]) == 0
    assert capsys.readouterr().out == f"{file}\n"


def test_verbose_lists_what_there_is(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["launch", "-v", "--dry-run", file, "what:=x"]) == 0
    told = capsys.readouterr().err.splitlines()
    assert f"file {file}" in told
    assert "parameter /number: 3" in told
    assert "node /deep/one (nodes/one)" in told


def test_local_leaves_out_what_is_for_other_computers(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = Path(file)
    far = '<machine name="far" address="192.0.2.1"/><node machine="far" pkg="nodes" type="one" name="there"/></launch>'
    path.write_text(path.read_text().replace("</launch>", far))
    assert main(["launch", "--local", "--dry-run", file, "what:=x"]) == 0
    captured = capsys.readouterr()
    assert "/there" not in captured.out
    assert "/two" in captured.out
    assert "--local: /there for far (192.0.2.1) left out" in captured.err
