from pathlib import Path

import numpy as np
import pytest

from ur.source.diagnostic import UserError
from ur.source.file import SourceFile
from ur_nodes.geometry.rigid import from_angles
from ur_nodes.vision.fiducial_map import MapEntry, format_map, parse_map, read_map, write_map

half = np.random.default_rng(0).normal(0.0, 0.01, (6, 6))
ENTRIES = (
    MapEntry(12, from_angles((1.0, -2.0, 2.4), (3.1, 0.1, -1.0)), half @ half.T, 7, (3,)),
    MapEntry(3, from_angles((0.0, 0.5, 0.6), (1.57, 0.0, 3.0)), np.eye(6) * 1e-4, 1, (12,)),
)


def test_map_survives_the_file(tmp_path: Path) -> None:
    write_map(tmp_path / "new" / "map.txt", ENTRIES)
    back = {entry.id: entry for entry in read_map(tmp_path / "new" / "map.txt")}
    for entry in ENTRIES:
        assert np.allclose(back[entry.id].pose, entry.pose, atol=1e-5)
        assert np.allclose(back[entry.id].covariance, entry.covariance, rtol=1e-3, atol=1e-12)
        assert (back[entry.id].observations, back[entry.id].links) == (entry.observations, entry.links)
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["map.txt"]


def test_same_map_is_the_same_text() -> None:
    assert format_map(ENTRIES) == format_map(reversed(ENTRIES))


def test_map_of_fiducial_slam_is_read() -> None:
    text = "103 -1.67 0.39 2.89 179.1 1.5 163.9 0.001 10 106 107\n"
    (entry,) = parse_map(SourceFile("map.txt", text))
    assert (entry.id, entry.observations, entry.links) == (103, 10, (106, 107))
    assert np.allclose(entry.pose[:3, 3], (-1.67, 0.39, 2.89))
    assert entry.pose[2, 2] < -0.99  # it hangs from the ceiling
    assert entry.variance == pytest.approx(0.001)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3\n", "3 values in a line"),
        ("1 0 0 0 0 0 0 0.1 1\n1 0 0 0 0 0 0 0.1 1\n", "fiducial 1 is given twice"),
        ("1 0 0 nan 0 0 0 0.1 1\n", "not finite"),
        ("one 0 0 0 0 0 0 0.1 1\n", "'one' is not a whole number, expected a number, x y z"),
        ("1 0 0 up 0 0 0 0.1 1\n", "'up' is not a number"),
        ("1 0 0 0 0 0 0 0.1 1 x\n", "'x' is not a whole number"),
        ("#covariance 1 2 3\n", "a covariance of 2 values, not of 21"),
    ],
)
def test_broken_maps_are_refused_with_the_line(text: str, message: str) -> None:
    with pytest.raises(UserError, match=message) as caught:
        parse_map(SourceFile("map.txt", "# a map\n" + text))
    span = caught.value.diagnostics[0].span
    assert span is not None
    assert span.position.line == 1 + text.count("\n")


def test_map_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match=r"cannot be written.*expected a place"):
        write_map(tmp_path / "file" / "map.txt", ENTRIES)
