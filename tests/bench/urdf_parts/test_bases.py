from pathlib import Path

from bench.urdf_parts.bases import clear_workspace


def test_base_of_an_earlier_run_makes_room_for_the_next_and_other_folders_stay(tmp_path: Path) -> None:
    made, other = tmp_path / "rover", tmp_path / "mine"
    (made / "share/ubiquity_launches/bases/rover").mkdir(parents=True)
    (other / "notes").mkdir(parents=True)
    clear_workspace(made, "rover")
    clear_workspace(other, "mine")
    assert [each.name for each in tmp_path.iterdir()] == ["mine"]
