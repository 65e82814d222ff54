import io
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from ur.cli.main import main
from ur.maps.picture_file import write_picture

VALUES = np.zeros((20, 40), np.int8)
VALUES[0] = 100


@pytest.fixture(autouse=True)
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    return write_picture(tmp_path / "plan", VALUES, 0.1, (0.0, 0.0, 0.0))


def test_map_is_imported_listed_renamed_exported_and_deleted(
    plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["maps", "import", str(plan), "flat"]) == 0
    waypoints = tmp_path / "data/ubiquity_launches/waypoints"
    waypoints.mkdir(parents=True)
    (waypoints / "flat.yaml").write_text("door: [1, 2, 90]\n", encoding="utf-8")
    assert main(["maps", "rename", "flat", "home"]) == 0
    assert (waypoints / "home.yaml").exists()
    assert main(["maps", "export", "home", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out.png").is_file()
    capsys.readouterr()
    assert main(["maps"]) == 0
    assert capsys.readouterr().out == "home: 4.0 x 2.0 m, picture only\n"
    assert main(["maps", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["name"] == "home"
    assert main(["maps", "show", "home"]) == 0
    assert "###" in capsys.readouterr().out
    assert main(["maps", "delete", "home", "--yes"]) == 0
    assert main(["maps"]) == 0
    assert capsys.readouterr().out == "home: deleted\nno maps yet; make one: ur run make_map\n"


def test_facts_for_scripts_hold_size_places_and_picture_and_a_damaged_map_hides_no_other(
    plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("flat", "hall"):
        assert main(["maps", "import", str(plan), name]) == 0
    data = tmp_path / "data/ubiquity_launches"
    (data / "waypoints").mkdir()
    (data / "waypoints/flat.yaml").write_text("door: [1, 2, 90]\nsofa: [1, 1, 0]\n", encoding="utf-8")
    (data / "maps/hall/map.json").write_text("{", encoding="utf-8")
    capsys.readouterr()
    assert main(["maps", "--json", "--pictures"]) == 0
    flat, hall = json.loads(capsys.readouterr().out)
    assert (flat["width"], flat["height"], flat["places"], flat["problem"]) == (4.0, 2.0, 2, "")
    assert [len(line) for line in flat["picture"]] == [40] * 10
    assert set(flat["picture"][-1]) == {"#"}
    assert (hall["width"], hall["picture"]) == (None, [])
    assert "not the record of a map" in hall["problem"]
    assert main(["maps", "--json"]) == 0
    assert "picture" not in json.loads(capsys.readouterr().out)[0]


def test_map_is_edited_by_commands(plan: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["maps", "import", str(plan), "flat"]) == 0
    for words in (
        ["wall", "1", "1", "1", "1.5"],
        ["origin", "1", "-0.5"],
        ["place", "front door", "2", "1", "90"],
        ["rotate", "-3.2"],
        ["keep-out", "0", "0", "1", "0.5"],
        ["zone", "hall", "40", "0", "0", "1", "0.5"],
        ["zone", "hall", "delete"],
    ):
        assert main(["maps", "edit", "flat", *words]) == 0
    assert capsys.readouterr().out.splitlines()[-7:] == [
        "flat: wall: 6 cells changed",
        "flat: (1, -0.5) is (0, 0) now",
        "flat: front door is at 2 1 90",
        "flat: turned by -3.2 degrees",
        "flat: zone keep-out: keep out, 0.5 square metres",
        "flat: zone hall: at most 40 % of the highest speed, 0.5 square metres",
        "flat: zone hall is deleted",
    ]
    written = (tmp_path / "data/ubiquity_launches/waypoints/flat.yaml").read_text(encoding="utf-8")
    assert '"front door": [2.053, 0.887, 86.8]' in written
    assert main(["maps", "edit", "flat", "place", "living room", "1", "1"]) == 0
    assert main(["maps", "edit", "flat", "place", "a/b", "1", "1"]) == 2
    assert "'a/b' is not a name of a place, expected at most 40 letters, digits, blanks" in capsys.readouterr().err
    for words in (
        ["explode"],
        ["rotate", "much"],
        ["rotate", "nan"],
        ["wall", "1"],
        ["place", "1", "2"],
        ["zone", "hall"],
    ):
        assert main(["maps", "edit", "flat", *words]) == 2
    for words in (["zone", "hall", "delete"], ["zone", "hall", "fast", "0", "0", "1", "1"], ["keep-out", "0", "0"]):
        assert main(["maps", "edit", "flat", *words]) == 2


def test_nothing_is_deleted_without_an_answer(
    plan: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("y\n"))
    assert main(["maps", "import", str(plan), "flat"]) == 0
    assert main(["maps", "delete", "flat"]) == 2
    assert "--yes deletes without asking" in capsys.readouterr().err
    assert main(["maps", "show", "flat"]) == 0


def test_damaged_map_is_listed_as_such(plan: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["maps", "import", str(plan), "flat"]) == 0
    next(plan.parent.glob("data/ubiquity_launches/maps/flat/*.pgm")).write_bytes(b"")
    assert main(["maps"]) == 0
    assert "flat: damaged: " in capsys.readouterr().out


@pytest.mark.parametrize(("threshold", "noted"), [("0.25", True), ("0.196", False)])
def test_import_notes_thresholds_that_make_unknown_floor_free(
    threshold: str, noted: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = write_picture(tmp_path / "plan", np.array(((0, 100, -1), (100, -1, 0)), dtype=np.int8), 0.1, (0.0, 0.0, 0.0))
    plan.write_text(plan.read_text().replace("free_thresh: 0.196", f"free_thresh: {threshold}"))
    assert f"free_thresh: {threshold}" in plan.read_text()
    assert main(["maps", "import", str(plan), "flat"]) == 0
    assert ("note: free_thresh: 0.25 makes the grey of unknown floor (205) free" in capsys.readouterr().out) is noted
