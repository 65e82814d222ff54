"""`ur docs` as it is typed."""

from pathlib import Path

import pytest

from ur.cli.main import main

LAUNCH = """<launch>
  <!--Summary: Talk.-->
  <arg name="word" default="hello"/>
  <!--word: What is said.-->
  <node name="talker" pkg="demo" type="talker" args="$(arg word)"/>
</launch>
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    package = tmp_path / "my_robot"
    (package / "launch").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>my_robot</name></package>")
    (package / "launch" / "talk.launch").write_text(LAUNCH)
    monkeypatch.chdir(package)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    return package


def test_page_is_written_beside_the_launch_files(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["docs"]) == 0
    assert "| `word` | text | `hello` | What is said. |" in (folder / "launches.md").read_text()
    assert capsys.readouterr().err == "launches.md: written\n"
    assert main(["docs"]) == 0
    assert capsys.readouterr().err == "launches.md: up to date\n"


def test_package_is_found_by_name(folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir("/")
    assert main(["docs", "my_robot", "--output", str(tmp_path / "page.md")]) == 0
    assert "[launch/talk.launch](my_robot/launch/talk.launch)" in (tmp_path / "page.md").read_text()
    assert not (folder / "launches.md").exists()


def test_check_fails_with_the_difference(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["docs", "--check"]) == 1
    assert not (folder / "launches.md").exists()
    main(["docs"])
    capsys.readouterr()
    assert main(["docs", "--check"]) == 0
    assert capsys.readouterr().err == "launches.md: up to date\n"
    launch = folder / "launch" / "talk.launch"
    launch.write_text(LAUNCH.replace("Talk.", "Shout."))
    capsys.readouterr()
    assert main(["docs", "--check"]) == 1
    shown = capsys.readouterr()
    assert "-Talk.\n+Shout.\n" in shown.out
    assert shown.out.startswith("--- launches.md\n+++ launches.md (made again)\n")
    assert "out of date" in shown.err
    assert "Talk." in (folder / "launches.md").read_text()


def test_output_to_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["docs", "--output", "-"]) == 0
    assert capsys.readouterr().out.startswith("# my_robot\n")


def test_broken_file_is_reported_and_documented(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "launch" / "broken.launch").write_text("<launch><node</launch>")
    assert main(["docs"]) == 0
    assert "broken.launch:1:" in capsys.readouterr().err
    assert "**Broken:**" in (folder / "launches.md").read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere"], "no such file, folder or package"),
        (["launch/talk.launch"], "is a file, expected the folder"),
        (["launch/talk.launch"], "help: ur docs ."),
        ([".", "--output", "/proc/no/page.md"], "cannot be written"),
        ([".", "--outptu", "x"], "did you mean '--output'"),
        ([".", "--site", "x"], "option '--site' was removed"),
        (["--site=x"], "help: write the page with '--output FILE.md'"),
    ],
)
def test_wrong_words_are_explained(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["docs", *words]) == 2
    assert said in capsys.readouterr().err


def test_folder_without_launch_files_is_explained(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty" / "readme").write_text("")
    assert main(["docs", str(tmp_path / "empty")]) == 2
    assert "holds no launch file" in capsys.readouterr().err
