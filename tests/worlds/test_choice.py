"""Arguments that choose worlds and maps."""

from pathlib import Path

import pytest

from ur.worlds.choice import explain_missing_map, explain_missing_world, list_worlds, resolve_path

PACKAGE = Path(__file__).resolve().parents[2] / "ubiquity_launches"


@pytest.mark.parametrize(
    ("argument", "resolved"),
    [
        ("world:=maze", "world:=maze"),
        ("world:=./home.yaml", "world:={folder}/home.yaml"),
        ("world:=home.yaml", "world:={folder}/home.yaml"),
        ("world:=new.yaml", "world:=new.yaml"),
        ("world:=../home.yaml", "world:={parent}/home.yaml"),
        ("map_file:=home.yaml", "map_file:={folder}/home.yaml"),
        ("map_file:=/a/b.yaml", "map_file:=/a/b.yaml"),
        ("map_file:=", "map_file:="),
        ("other:=home.yaml", "other:=home.yaml"),
    ],
)
def test_relative_paths_start_at_the_working_folder(argument: str, resolved: str, tmp_path: Path) -> None:
    (tmp_path / "home.yaml").touch()
    wanted = resolved.format(folder=tmp_path, parent=tmp_path.parent)
    name, _, value = argument.partition(":=")
    assert f"{name}:={resolve_path(name, value, tmp_path)}" == wanted


def test_files_that_do_not_exist_yet_are_resolved_for_the_launch_library(tmp_path: Path) -> None:
    assert resolve_path("map_file", "new.txt", tmp_path, always=True) == f"{tmp_path}/new.txt"
    assert resolve_path("world", "maze", tmp_path, always=True) == "maze"


@pytest.mark.parametrize(
    ("path", "message", "help_"),
    [
        ("{package}/n_simulator/worlds/mazee.yaml", "unknown world 'mazee', expected one of", "world:=maze?"),
        ("{package}/n_simulator/worlds/plan.png.yaml", "unknown world 'plan.png'", "--picture plan.png"),
        ("{package}/n_simulator/worlds/qqq.yaml", "unknown world 'qqq'", "'ur new world NAME'"),
        ("{folder}/hme.yaml", "hme.yaml' does not exist", "did you mean 'home.yaml'?"),
        ("{folder}/no/such.yaml", "such.yaml' does not exist", "'ur new world NAME'"),
    ],
)
def test_missing_world_is_explained_with_what_there_is(path: str, message: str, help_: str, tmp_path: Path) -> None:
    (tmp_path / "home.yaml").touch()
    (found,) = explain_missing_world(path.format(package=PACKAGE, folder=tmp_path), PACKAGE).diagnostics
    assert message in found.message
    assert ", ".join(list_worlds(PACKAGE)) in found.message
    assert help_ in str(found.help)


def test_missing_map_is_explained_with_its_neighbour(tmp_path: Path) -> None:
    (tmp_path / "home.yaml").touch()
    (found,) = explain_missing_map(str(tmp_path / "hme.yaml")).diagnostics
    assert found.help == "did you mean 'home.yaml'?"
