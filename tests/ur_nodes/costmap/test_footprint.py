import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from tests.ur_nodes.navigation.closed_loop import MAGNI, STAGE

from ur.robot.base import load_base
from ur_nodes.costmap.footprint import footprint_of_outline, footprint_of_radius

PACKAGE = Path(__file__).parents[3] / "ubiquity_launches"


def test_footprint_radii_of_a_rectangle() -> None:
    footprint = footprint_of_outline(MAGNI, 0.05)
    assert footprint.inscribed == pytest.approx(0.13)
    assert footprint.circumscribed == pytest.approx(math.hypot(0.28, 0.205))


def test_footprint_samples_leave_no_hole_wider_than_the_resolution() -> None:
    footprint = footprint_of_outline(STAGE, 0.05)
    places = np.random.default_rng(1).uniform(-0.2, 0.2, (500, 2))
    inside = places[(abs(places) < (0.16, 0.15)).all(axis=1)]
    gaps = np.hypot(*(inside[:, None] - footprint.samples).transpose(2, 0, 1)).min(axis=1)
    assert gaps.max() <= 0.05 * math.sqrt(0.5) + 1e-9


def test_footprint_padding_moves_the_outline_out() -> None:
    assert footprint_of_outline(MAGNI, 0.05, 0.01).inscribed == pytest.approx(0.14)


def test_footprint_of_radius_is_almost_round() -> None:
    footprint = footprint_of_radius(0.3, 0.05)
    assert footprint.circumscribed == pytest.approx(0.3)
    assert footprint.inscribed > 0.29


@pytest.mark.parametrize("points", [((0.1, 0.0), (0.0, 0.1)), ((1.0, 1.0), (2.0, 1.0), (2.0, 2.0))])
def test_footprint_refuses_what_does_not_enclose_the_base(points: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(ValueError, match=r"corners|outside"):
        footprint_of_outline(points, 0.05)


@pytest.mark.parametrize("path", sorted((PACKAGE / "n_move_base" / "params").glob("*.yaml")), ids=lambda p: p.stem)
def test_parameters_of_a_base_agree_with_its_base_file(path: Path) -> None:
    parameters = yaml.safe_load(path.read_text(encoding="utf-8"))
    base = load_base(PACKAGE, path.stem)
    for costmap in ("global_costmap", "local_costmap"):
        assert tuple(map(tuple, parameters[costmap]["footprint"])) == base.footprint
    dwa = parameters["DWAPlannerROS"]
    assert dwa["max_vel_x"] <= base.limits.velocity
    assert dwa["max_vel_theta"] <= base.limits.angular_velocity
    assert dwa["acc_lim_x"] <= base.limits.acceleration
    assert dwa["acc_lim_theta"] <= base.limits.angular_acceleration
