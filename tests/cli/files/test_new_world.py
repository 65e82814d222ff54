"""`ur new world`: what it writes, and what it refuses."""

from pathlib import Path

import pytest
from PIL import Image

from ur.cli.main import main
from ur.worlds.world_file import read_world


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Image.new("L", (400, 300), 255).save(tmp_path / "plan.png")
    return tmp_path


def test_picture_becomes_a_world_of_its_size(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "world", "home", "--picture", "plan.png", "--width", "10"]) == 0
    said = capsys.readouterr()
    assert said.out.split() == ["wrote", "home.png", "wrote", "home.yaml"]
    assert "a wall was drawn around it" in said.err
    assert "next: ur run keyboard_navigate world:=./home.yaml" in said.err
    plan = read_world(folder / "home.yaml").floor_plan
    assert plan.shape == (154, 204)  # 200 x 150 cells, and the wall
    assert plan.wall_at(0.0, 0.0) is False


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "NAME is required"),
        (["home"], "neither --picture nor --size is given"),
        (["home", "--size", "8"], "expected WIDTHxHEIGHT in m"),
        (["home", "--size", "0.1x8"], "--size 0.1, expected 1 to 1000 m"),
        (["home", "--size", "900x900"], "expected at most 4000"),
        (["home", "--size", "8x6", "--cell", "nan"], "--cell nan"),
        (["home", "--size", "8x6", "--width", "3"], "--width belongs to --picture"),
        (["home", "--size", "8x6", "--picture", "plan.png"], "cannot be used together"),
        (["home", "--picture", "plan.png"], "--width is not given"),
        (["home", "--picture", "plan.png", "--width", "-1"], "--width -1, expected"),
        (["home", "--picture", "none.png", "--width", "8"], "picture 'none.png' does not exist"),
        (["a/b", "--size", "8x6"], "world name 'a/b'"),
        (["plan", "--size", "8x6"], "plan.png is there already"),
    ],
)
def test_wrong_request_is_refused_and_nothing_is_written(
    words: list[str], said: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", "world", *words]) == 2
    assert said in capsys.readouterr().err
    assert [path.name for path in folder.iterdir()] == ["plan.png"]
