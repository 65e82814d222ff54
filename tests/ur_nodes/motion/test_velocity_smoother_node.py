"""The smoother on a bus."""

from itertools import pairwise

import pytest

from ur.source.diagnostic import UserError
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.velocity_smoother_node import start
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Twist

LIMITS = {"accel_lim_v": 1.0, "accel_lim_w": 2.0, "speed_lim_v": 0.2, "speed_lim_w": 1.0}


def smoothed(bus: Bus, pauses: list[float]) -> list[float]:
    """What comes of commands ahead with pauses (s) after each."""
    bus.parameters |= {f"/smoother/{name}": value for name, value in LIMITS.items()}
    got: list[float] = []
    client = bus.node("client")
    client.subscribe("smoother/smooth_cmd_vel", Twist, lambda twist: got.append(twist.forward), Quality.EVERY)
    start(bus.node("smoother"))
    raw = client.publish("smoother/raw_cmd_vel", Twist, Quality.EVERY)
    for pause in pauses:
        raw.send(Twist(0.5, 0.0))
        bus.run(pause)
    bus.run(1.0)
    return got


def test_velocity_ramps_within_its_limits_and_back_to_rest() -> None:
    got = smoothed(Bus(), [1.0 / 30.0] * 60)
    assert max(got) == 0.2
    assert max(abs(b - a) for a, b in pairwise([0.0, *got])) <= 1.0 / 20.0 + 1e-6
    assert got[-3:] == [0.0, 0.0, 0.0]


def test_commands_that_a_network_held_back_do_not_leave_as_new_ones() -> None:
    assert not any(smoothed(Bus(), [0.0] * 50))


@pytest.mark.parametrize(("limit", "fastest"), [(0.1, 0.1), (0.0, 0.0)])
def test_velocity_to_the_side_is_that_of_a_base_that_drives_sideways(limit: float, fastest: float) -> None:
    bus = Bus()
    bus.parameters |= {f"/smoother/{name}": value for name, value in (LIMITS | {"speed_lim_y": limit}).items()}
    got: list[float] = []
    client = bus.node("client")
    client.subscribe("smoother/smooth_cmd_vel", Twist, lambda twist: got.append(twist.left), Quality.EVERY)
    start(bus.node("smoother"))
    raw = client.publish("smoother/raw_cmd_vel", Twist, Quality.EVERY)
    for _ in range(60):
        raw.send(Twist(0.1, 0.0, 0.5))
        bus.run(1.0 / 30.0)
    assert max(got) == fastest


def test_missing_limit_is_named() -> None:
    with pytest.raises(UserError, match="parameter /smoother/accel_lim_v is not set"):
        start(Bus().node("smoother"))
