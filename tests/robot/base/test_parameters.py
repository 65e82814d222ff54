"""Parameter files of a new base, made from those of another."""

import dataclasses

import pytest
import yaml
from tests.base_contract import PACKAGE, load

from ur.robot.base import Base
from ur.robot.base.parameters import fit_parameters


@pytest.fixture(scope="module")
def omni() -> Base:
    stage = load("stage", "")
    limits = dataclasses.replace(stage.limits, velocity=0.5, acceleration=0.8, lateral_velocity=0.4)
    return dataclasses.replace(stage, name="rover", limits=limits)


def read(node: str) -> str:
    return (PACKAGE / node / "params" / "stage.yaml").read_text(encoding="utf-8")


def test_navigation_may_be_slower_than_its_base_and_than_teleop(omni: Base) -> None:
    planner = yaml.safe_load(fit_parameters(read("n_move_base"), "stage", omni, (0.26, 0.9)))["DWAPlannerROS"]
    assert [planner[f"max_vel_{key}"] for key in ("x", "trans", "theta")] == [0.26, 0.26, 0.9]
    for node in ("n_velocity_smoother", "n_teleop_twist_keyboard", "n_teleop_twist_joy"):
        assert fit_parameters(read(node), "stage", omni, (0.26, 0.9)) == fit_parameters(read(node), "stage", omni)


def test_parameters_of_a_base_that_drives_sideways_permit_it(omni: Base) -> None:
    planner = yaml.safe_load(fit_parameters(read("n_move_base"), "stage", omni))["DWAPlannerROS"]
    assert (planner["max_vel_y"], planner["min_vel_y"], planner["acc_lim_y"]) == (0.4, -0.4, 0.8)
    assert planner["vy_samples"] > 1
    amcl = yaml.safe_load(fit_parameters(read("n_amcl"), "stage", omni))
    assert (amcl["odom_model_type"], amcl["odom_alpha5"]) == ("omni-corrected", amcl["odom_alpha4"])
    assert yaml.safe_load(fit_parameters(read("n_velocity_smoother"), "stage", omni))["speed_lim_y"] == 0.4
    joystick = yaml.safe_load(fit_parameters(read("n_teleop_twist_joy"), "stage", omni))
    assert joystick["scale_linear"] == {"x": 0.3, "y": 0.24}
    assert joystick["scale_linear_turbo"] == {"x": 0.5, "y": 0.4}


@pytest.mark.parametrize("node", ["n_move_base", "n_amcl", "n_teleop_twist_joy", "n_velocity_smoother"])
def test_parameters_of_a_wheeled_base_are_the_same_when_made_from_those_of_one_that_drives_sideways(
    omni: Base, node: str
) -> None:
    wheeled = dataclasses.replace(omni, limits=dataclasses.replace(omni.limits, lateral_velocity=0.0))
    direct = yaml.safe_load(fit_parameters(read(node), "stage", wheeled))
    back = yaml.safe_load(fit_parameters(fit_parameters(read(node), "stage", omni), "rover", wheeled))
    assert {key: value for key, value in back.items() if key != "odom_alpha5"} == direct


def test_local_costmap_of_a_fast_base_reaches_as_far_as_it_needs_to_brake() -> None:
    stage = load("stage", "")
    fast = dataclasses.replace(stage, name="rover", limits=dataclasses.replace(stage.limits, velocity=2.0))
    local = yaml.safe_load(fit_parameters(read("n_move_base"), "stage", fast))["local_costmap"]
    assert local["width"] == local["height"] >= 2.0 * (2.0**2 / (2.0 * 0.6 * fast.limits.acceleration))
    assert local["obstacle_layer"]["scan"]["obstacle_range"] > 2.5
    usual = yaml.safe_load(fit_parameters(read("n_move_base"), "stage", dataclasses.replace(stage, name="rover")))
    assert usual == yaml.safe_load(read("n_move_base"))
