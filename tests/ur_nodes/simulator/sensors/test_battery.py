from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.robot.base import Base, BatteryProperties
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.sensors.battery import BatteryCharge, BatterySense
from ur_nodes.simulator.simulation import Simulation

BATTERY = BatteryProperties("battery_state", "lead-acid", 7.0, 25.6, 21.0, 1.0, 4.0)
Drive = Callable[..., None]


def test_full_battery_lasts_capacity_over_current() -> None:
    battery = BatteryCharge(BATTERY)
    assert (battery.fraction, battery.voltage) == (1.0, 25.6)
    battery.draw(0.0, 3600.0)
    assert battery.charge == pytest.approx(6.0)
    assert battery.current == -1.0
    battery.draw(1.0, 1800.0)
    assert battery.charge == pytest.approx(4.0)
    battery.draw(1.0, 1e6)
    assert (battery.charge, battery.fraction, battery.voltage) == (0.0, 0.0, 21.0)


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 5000.0)), max_size=20), st.floats(-1.0, 2.0))
def test_charge_only_falls_and_voltage_follows_it(draws: list[tuple[float, float]], fraction: float) -> None:
    battery = BatteryCharge(BATTERY, fraction)
    assert 0.0 <= battery.fraction <= 1.0
    for effort, seconds in draws:
        before = battery.charge
        battery.draw(effort, seconds)
        assert 0.0 <= battery.charge <= before
        assert 21.0 <= battery.voltage <= 25.6
        assert -4.0 <= battery.current <= -1.0


def test_driving_base_draws_more_than_one_that_stands(room: WorldModel, stage: Base, drive: Drive) -> None:
    def left_after(speed: float) -> float:
        simulation = Simulation(room, replace(stage, battery=BATTERY), charge=0.5)
        drive(simulation, 6.0, speed, 0.3 if speed else 0.0)
        battery = simulation.senses[0].find(BatterySense).charge
        assert battery is not None
        return battery.charge

    idle, moving = left_after(0.0), left_after(stage.limits.velocity)
    assert 3.5 - idle == pytest.approx(6.0 / 3600.0)
    assert 6.0 / 3600.0 * 3.0 < 3.5 - moving < 6.0 / 3600.0 * 4.0


def test_reset_fills_the_battery_as_at_the_start(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, replace(stage, battery=BATTERY), charge=0.5)
    drive(simulation, 3.0, 0.3)
    simulation.reset()
    battery = simulation.senses[0].find(BatterySense).charge
    assert battery is not None
    assert battery.charge == 3.5
