"""No motion without a fresh command: real commanders and muxes on two computers, whatever happens to the network."""

import time
from collections.abc import Callable, Iterator

import pytest
from bench.stop_network_parts.network import Network, start_network

LIGHT = ("keyboard", "joystick", "plain", "rostopic")
_ATTEMPTS = 3  # where this computer is too busy to measure

Happen = Callable[[Network], None]


@pytest.fixture(scope="module")
def network() -> Iterator[Network]:
    """A laptop and a robot with all commanders, each along both axes."""
    with start_network("magni", LIGHT) as running:
        yield running


@pytest.fixture(autouse=True)
def mended(network: Network) -> Iterator[None]:
    yield
    network.laptop.machine.restore()
    network.laptop.resume()
    network.start_laptop()


def stays_safe(network: Network, pattern: str, happen: Happen) -> None:
    """Assert that no lane moves without a fresh command, nor for too long after the last."""
    for _ in range(_ATTEMPTS):
        trials = network.run("test", pattern, happen)
        assert not [trial.lane.name for trial in trials if not trial.verdict.recorded], "no record of what was sent"
        ghosts = {trial.lane.name: trial.verdict.ghosts for trial in trials if trial.verdict.ghosts}
        assert not ghosts
        if not any(trial.disturbed for trial in trials):
            break
        network.start_laptop()
    late = {trial.lane.name: trial.verdict.longest for trial in trials if trial.verdict.longest > trial.lane.limit}
    assert all(trial.disturbed for trial in trials if trial.lane.name in late), late


def cut_and_restore(network: Network, seconds: float, meanwhile: Happen | None = None) -> None:
    network.laptop.machine.cut()
    time.sleep(seconds / 2.0)
    if meanwhile:
        meanwhile(network)
    time.sleep(seconds / 2.0)
    network.laptop.machine.restore()


def test_robot_ignores_what_killed_programs_left_behind_when_the_network_is_back(network: Network) -> None:
    def happen(running: Network) -> None:
        cut_and_restore(running, 10.0, lambda it: it.laptop.kill_everything())

    stays_safe(network, "held", happen)


@pytest.mark.parametrize("pattern", ["held", "alternating"])
def test_robot_obeys_nothing_old_when_the_network_is_back(network: Network, pattern: str) -> None:
    stays_safe(network, pattern, lambda running: cut_and_restore(running, 8.0))


def test_robot_stops_while_the_laptop_is_suspended_and_obeys_nothing_old_afterwards(network: Network) -> None:
    def happen(running: Network) -> None:
        running.laptop.suspend()
        time.sleep(6.0)
        running.laptop.resume()
        time.sleep(2.0)

    stays_safe(network, "alternating", happen)


def test_robot_stops_when_its_commander_is_killed(network: Network) -> None:
    def happen(running: Network) -> None:
        for lane in running.lanes:
            running.laptop.order("kill", name=lane.name)

    stays_safe(network, "held", happen)
