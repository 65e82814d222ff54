from __future__ import annotations

from pathlib import Path

import pytest

from ur.request.localisation import choose_localisation
from ur.source.diagnostic import UserError

LIBRARY = Path(__file__).parents[2] / "ubiquity_launches"
FILES = [str(LIBRARY / "m_keyboard_navigate" / "launch" / "m_keyboard_navigate.launch.xml")]
DECLARED = ("robot_base", "robot_variant", "localisation")


def test_base_with_a_camera_alone_is_localised_by_fiducials() -> None:
    assert choose_localisation(FILES, DECLARED, {"robot_base": "magni"}) == ["localisation:=fiducials"]


@pytest.mark.parametrize(
    "values",
    [
        {"robot_base": "stage"},
        {"robot_base": "magni", "robot_variant": "lidar"},
        {"robot_base": "magni", "localisation": "amcl"},
        {},
    ],
)
def test_lidar_or_what_is_given_decides(values: dict[str, str]) -> None:
    assert choose_localisation(FILES, DECLARED, values) == []


def test_nothing_is_added_where_it_is_not_declared() -> None:
    assert choose_localisation(FILES, ("robot_base",), {"robot_base": "magni"}) == []
    assert choose_localisation(["/tmp/x.launch"], DECLARED, {"robot_base": "magni"}) == []


def test_way_that_there_is_not_is_refused() -> None:
    with pytest.raises(UserError, match="localisation:=fiducial, expected one of amcl, fiducials") as caught:
        choose_localisation(FILES, DECLARED, {"robot_base": "magni", "localisation": "fiducial"})
    assert caught.value.diagnostics[0].help == "did you mean 'fiducials'?"
