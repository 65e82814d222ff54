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


def test_selection_that_is_a_link_stays_one(config: Path, tmp_path: Path) -> None:
    link, target = config / "ubiquity_launches/selection", tmp_path / "dotfiles" / "selection"
    for folder in (link.parent, target.parent):
        folder.mkdir()
    target.write_text("sim\n")
    link.symlink_to(target)
    assert main(["use", "sim:magni"]) == 0
    assert link.is_symlink()
    assert target.read_text() == "sim:magni\n"


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("sim:mangi", "did you mean 'magni'?"),
        ("sim:magni:lidr", "did you mean 'lidar'?"),
        ("a b", "'a b' is not a valid host name"),
        ("sim:stage:x:y", "too many parts"),
        ("sim::lidar", "a variant needs its base"),
        ("sim:", "nothing follows the last ':'"),
        ("sim:magni:", "nothing follows the last ':'"),
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


@pytest.fixture
def bob(config: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A robot that was set up from here, and a network on which no name but `alice.local` resolves."""
    monkeypatch.setenv("XDG_STATE_HOME", str(config / "state"))
    monkeypatch.setattr("ur.robot.discovery.seen._resolves", lambda host: host == "alice.local")
    folder = config / "ubiquity_launches" / "robots"
    folder.mkdir(parents=True)
    (folder / "bob.yaml").write_text('name: "bob"\nuser: "ros"\nbase: "magni"\n')
    return config / "ubiquity_launches" / "selection"


def test_robot_that_was_set_up_from_here_is_selected_also_while_it_is_away(
    bob: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["use", "bob"]) == 0
    assert capsys.readouterr() == ("bob\n", "")
    assert bob.read_text() == "bob\n"


@pytest.mark.parametrize(
    ("word", "help_"),
    [
        ("magni", "the simulated one is 'ur use sim:magni'"),
        ("magni:lidar", "the simulated one is 'ur use sim:magni:lidar'"),
        ("bobb", "did you mean 'ur use bob'?"),
        ("mangi", "did you mean the simulated robot 'ur use sim:magni'?"),
        ("unlike", "'ur robots' lists the robots on the network"),
    ],
)
def test_unknown_robot_is_refused_and_the_selection_stays(
    word: str, help_: str, bob: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["use", word]) == 2
    said = capsys.readouterr().err
    assert f"unknown robot {word.partition(':')[0]!r}" in said
    assert help_ in said
    assert f"ur use --away {word}" in said
    assert not bob.exists()


def test_robot_that_is_away_is_selected_on_purpose(bob: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["use", "--away", "magni"]) == 0
    said = capsys.readouterr()
    assert said.out == bob.read_text() == "magni\n"
    assert "note: robot 'magni' was not set up from this computer" in said.err


@pytest.mark.parametrize("known_by", ["its answer", "the memory of robots seen"])
def test_robot_that_others_set_up_is_selected_with_a_note(
    known_by: str, bob: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = "alice"
    if known_by != "its answer":
        name = "carol"
        seen = bob.parent.parent / "state" / "ubiquity_launches" / "seen.json"
        seen.parent.mkdir(parents=True)
        seen.write_text('[{"name": "carol", "address": "10.0.0.3", "time": 1.0}]')
    assert main(["use", name]) == 0
    assert f"note: robot '{name}' was not set up from this computer" in capsys.readouterr().err
    assert bob.read_text() == f"{name}\n"
