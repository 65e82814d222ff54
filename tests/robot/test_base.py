from __future__ import annotations

from pathlib import Path

import pytest

from ur.robot.base import list_bases, list_variants, load_base, read_base
from ur.source.diagnostic import UserError

PACKAGE = Path(__file__).parents[2] / "ubiquity_launches"
GOOD = (PACKAGE / "bases" / "stage" / "base.yaml").read_text(encoding="utf-8")
EVERY = [(name, variant) for name in list_bases(PACKAGE) for variant in ("", *list_variants(PACKAGE, name))]


def read_text(tmp_path: Path, text: str, variant: str = "") -> str:
    path = tmp_path / "base.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_base(path, "odd", variant)
    return str(caught.value).replace(str(path), "base.yaml")


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_every_base_of_the_library_is_good(name: str, variant: str) -> None:
    base = load_base(PACKAGE, name, variant)
    assert (base.name, base.variant) == (name, variant)
    area = sum(
        x0 * y1 - x1 * y0
        for (x0, y0), (x1, y1) in zip(base.footprint, (*base.footprint[1:], base.footprint[0]), strict=True)
    )
    assert area > 0, "the footprint goes round counter-clockwise"
    half = base.wheels.separation / 2 + base.wheels.width / 2
    assert max(y for _, y in base.footprint) >= half, "the wheels are inside the footprint"


def test_variant_adds_to_the_plain_base() -> None:
    plain, variant = load_base(PACKAGE, "magni"), load_base(PACKAGE, "magni", "lidar")
    assert plain.lidar is None
    assert variant.lidar is not None
    assert variant.wheels == plain.wheels


def test_unknown_base_names_the_nearest() -> None:
    with pytest.raises(UserError) as caught:
        load_base(PACKAGE, "magnni")
    (finding,) = caught.value.diagnostics
    assert "expected one of" in finding.message
    assert finding.help == "did you mean 'magni'?"


def test_unknown_variant_names_those_there_are() -> None:
    with pytest.raises(UserError, match="variant 'lidr' of base 'magni' is not known, expected one of lidar"):
        load_base(PACKAGE, "magni", "lidr")
    with pytest.raises(UserError, match="this base has no variants"):
        load_base(PACKAGE, "stage", "lidar")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("radius: 0.08", "radius: round", "base.yaml:7:18: radius: 'round' in a base file, wheels, expected a number"),
        ("radius: 0.08", "radius: -1", "expected at least 0.005"),
        ("radius: 0.08", "raduis: 0.08", "radius is missing in a base file, wheels"),
        ("mass: 8.0", "", "mass is missing in a base file, expected a number"),
        ("height: 0.25", "height: 0.25\nheigth: 1", "heigth is not known in a base file"),
        ("height: 0.25", "height: 0.25\nheight: 1", "height is given twice in a base file"),
        ("samples: 360", "samples: 1.5", "samples: 1.5 in a base file, sensors, lidar, expected a whole number"),
        ("footprint: [[", "footprint: [[[", "expected"),
        ("angle_max: 3.12413936", "angle_max: -4", "expected more than angle_min"),
    ],
)
def test_mistake_in_a_base_file_is_placed_and_explained(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert old in GOOD
    message = read_text(tmp_path, GOOD.replace(old, new))
    assert expected in message
    assert message.startswith("base.yaml:")


def test_broken_variant_is_found_whichever_is_asked_for(tmp_path: Path) -> None:
    assert "mass: 'much'" in read_text(tmp_path, GOOD + "variants:\n  heavy:\n    mass: much\n")
