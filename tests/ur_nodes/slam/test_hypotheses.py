"""Which place of the map several scans agree on."""

import math
from dataclasses import replace

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.hypotheses import Hypotheses
from ur_nodes.slam.relocation import Fit, PlaceVerdict

HERE = Pose2(4.0, 1.0, 0.5)
STEP = Pose2(0.5, 0.0, 0.0)
UNCLEAR, REFUTED = PlaceVerdict(None, refuted=False), PlaceVerdict(None, refuted=True)


def fit_at(pose: Pose2) -> Fit:
    """A fit that alone would not be enough."""
    return Fit(pose, 0, pose, np.eye(3), 0.7, alone=False)


def poses(count: int) -> list[Pose2]:
    """The keyframes of the small map."""
    found = [Pose2(0.0, 0.0, 0.0)]
    for _ in range(count - 1):
        found.append(found[-1].compose(STEP))
    return found


def test_robot_that_was_not_carried_is_found_by_two_scans_once_people_have_gone() -> None:
    hypotheses = Hypotheses(on_map=False, expected=HERE)
    first, second, third, fourth = poses(4)
    hypotheses.add(0, first, (), lambda _: REFUTED)  # people stand round
    hypotheses.add(1, second, (), lambda _: UNCLEAR)
    drifted = Pose2(0.3, -0.2, 0.1)  # so far the small map went wrong among them
    hypotheses.add(2, third, (), lambda guess: PlaceVerdict(fit_at(guess.compose(drifted)), refuted=False))
    assert hypotheses.winner() is None
    hypotheses.add(3, fourth, (), lambda guess: PlaceVerdict(fit_at(guess), refuted=False))
    winner = hypotheses.winner()
    assert winner is not None
    assert winner.expected
    assert [number for number, _ in winner.fits] == [2, 3]


def test_two_weak_fits_elsewhere_are_not_enough() -> None:
    hypotheses = Hypotheses(on_map=False, expected=HERE)
    elsewhere = Pose2(-3.0, 2.0, 0.0)
    for number, pose in enumerate(poses(2)):
        hypotheses.add(number, pose, [fit_at(elsewhere.compose(pose))], lambda _: UNCLEAR)
    assert hypotheses.winner() is None


def test_scans_that_fit_elsewhere_outweigh_the_place_where_the_robot_was() -> None:
    hypotheses = Hypotheses(on_map=False, expected=HERE)
    elsewhere = Pose2(-3.0, 2.0, 0.0)
    for number, pose in enumerate(poses(6)):
        hypotheses.add(number, pose, [fit_at(elsewhere.compose(pose))], lambda _: REFUTED)
    winner = hypotheses.winner()
    assert winner is not None
    assert not winner.expected
    assert winner.pose == elsewhere


def test_expected_place_without_a_fit_is_no_rival() -> None:
    hypotheses = Hypotheses(on_map=False, expected=HERE)
    hypotheses.add(0, Pose2(0.0, 0.0, 0.0), [fit_at(Pose2(1.0, 1.0, 0.0))], lambda _: UNCLEAR)
    assert hypotheses.rivals() == []


def test_walls_that_are_looked_through_add_up_until_one_of_two_places_leads() -> None:
    hypotheses, twin = Hypotheses(on_map=True), Pose2(8.0, 1.0, 0.5)
    needed = 0
    for number, pose in enumerate(poses(12)):
        there = replace(fit_at(twin.compose(pose)), against=0.05)  # both have moved furniture, too
        hypotheses.add(number, pose, [there, replace(fit_at(HERE.compose(pose)), against=0.02)], lambda _: UNCLEAR)
        needed += hypotheses.winner() is None
    winner = hypotheses.winner()
    assert winner is not None
    assert math.dist(winner.pose, HERE) < 1e-9
    assert 1 < needed < 6


def test_places_that_are_looked_through_alike_are_never_told_apart() -> None:
    hypotheses, twin = Hypotheses(on_map=True), Pose2(8.0, 1.0, 0.5)
    for number, pose in enumerate(poses(30)):
        fits = [replace(fit_at(place.compose(pose)), against=0.04) for place in (HERE, twin)]
        hypotheses.add(number, pose, fits, lambda _: UNCLEAR)
        assert hypotheses.winner() is None
    assert len(hypotheses.rivals()) == 2


def test_people_who_stand_round_a_robot_do_not_speak_against_its_place() -> None:
    hypotheses = Hypotheses(on_map=False, expected=HERE)
    elsewhere = Pose2(-3.0, 2.0, 0.0)
    through = PlaceVerdict(None, refuted=False, against=0.4)
    for number, pose in enumerate(poses(3)):
        hypotheses.add(number, pose, [fit_at(elsewhere.compose(pose))], lambda _: through)
    assert hypotheses.winner() is None
