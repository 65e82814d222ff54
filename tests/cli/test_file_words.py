"""The forms in which verbs take a launch file: `FILE` and `PACKAGE FILE`, in our package without any set-up."""

from pathlib import Path

import pytest

from ur.cli.main import main

PART = "n_amcl.launch.xml"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)


@pytest.mark.parametrize(
    "words",
    [
        ["graph", "ubiquity_launches", PART],
        ["explain", "ubiquity_launches", PART, "min_particles"],
        ["launch", "--nodes", "ubiquity_launches", PART],
        ["check", "ubiquity_launches", PART],
        ["format", "--check", "ubiquity_launches", PART],
        ["find", "robot_base", "ubiquity_launches", PART],
    ],
)
def test_verb_takes_a_package_and_a_file_name(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 0, capsys.readouterr().err


def test_explain_takes_the_base_from_the_selection(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["use", "sim:magni"]) == 0
    capsys.readouterr()
    assert main(["explain", "ubiquity_launches", PART, "robot_base"]) == 0
    assert "argument robot_base = 'magni'" in capsys.readouterr().out


def test_explain_without_a_name_asks_for_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "ubiquity_launches", PART]) == 2
    assert "expected NAME" in capsys.readouterr().err


def test_tab_offers_the_launch_files_of_our_package(capsys: pytest.CaptureFixture[str]) -> None:
    assert "m_robot_base.launch.xml" in offered("ur launch ubiquity_launches m_", capsys)


def test_tab_offers_rules_and_groups_after_select(capsys: pytest.CaptureFixture[str]) -> None:
    assert {"unused-argument", "unknown-machine"} <= offered("ur check --select un", capsys)
    assert "machines" in offered("ur check --ignore ma", capsys)


def test_tab_offers_the_names_of_a_file_to_explain(capsys: pytest.CaptureFixture[str]) -> None:
    line = f"ur explain ubiquity_launches {PART} "
    assert {"amcl", "min_particles", "robot_base"} <= offered(line, capsys)
    assert "/amcl/min_particles" in offered(f"{line}/amcl/min", capsys)


def offered(line: str, capsys: pytest.CaptureFixture[str]) -> set[str]:
    from ur.cli.computer.completing import answer_completion

    assert answer_completion(["fish", line]) == 0
    return {row.split("\t")[1] for row in capsys.readouterr().out.splitlines()}
