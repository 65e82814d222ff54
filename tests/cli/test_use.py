from __future__ import annotations

from pathlib import Path

import pytest

from ur.cli.main import main


@pytest.fixture(autouse=True)
def config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return tmp_path


def test_nothing_selected_means_the_simulated_stage(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["use"]) == 0
    assert capsys.readouterr().out == "sim:stage\n"


def test_selection_is_kept(capsys: pytest.CaptureFixture[str], config: Path) -> None:
    assert main(["use", "sim:magni:lidar"]) == 0
    assert main(["use"]) == 0
    assert capsys.readouterr().out == "sim:magni:lidar\n" * 2
    assert [path.name for path in (config / "ubiquity_launches").iterdir()] == ["selection"]


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("sim:mangi", "did you mean 'magni'?"),
        ("sim:magni:lidr", "did you mean 'lidar'?"),
        ("a b", "'a b' is not the name of a computer"),
        ("sim:stage:x:y", "too many parts"),
        ("sim::lidar", "a variant needs its base"),
    ],
)
def test_bad_selection_is_explained_and_changes_nothing(
    word: str, told: str, config: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["use", word]) == 2
    assert told in capsys.readouterr().err
    assert not (config / "ubiquity_launches").exists()


def test_broken_selection_file_says_how_to_repair_it(config: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (config / "ubiquity_launches").mkdir()
    (config / "ubiquity_launches/selection").write_text("???")
    assert main(["use"]) == 2
    assert "'ur use sim' selects the simulated robot again" in capsys.readouterr().err
    assert main(["use", "sim"]) == 0


def test_robot_that_was_never_set_up_from_here_is_selected_with_a_note(
    config: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = config / "ubiquity_launches" / "robots"
    folder.mkdir(parents=True)
    (folder / "bob.yaml").write_text('name: "bob"\nuser: "ros"\nbase: "magni"\n')
    for word, note in (
        ("bob", ""),
        ("bobb", "did you mean 'ur use bob'?"),
        ("unlike", "'ur robots' shows who is there"),
    ):
        assert main(["use", word]) == 0
        said = capsys.readouterr()
        assert said.out == f"{word}\n"
        assert note in said.err
        assert bool(said.err) is bool(note)
