"""The route to a robot that cannot be reached: the step that fails is named, with what helps."""

import pytest

from ur.robot.discovery.record import RobotRecord
from ur.robot.discovery.seen import SeenRobot
from ur.robot.doctor.route import RouteState, explain_route, list_steps
from ur.robot.ssh.address import Address
from ur.robot.ssh.host_key import HostKey

ADDRESS = Address("ros", "bob.local")
RECORD = RobotRecord("bob", "ros", "magni")
THERE = RouteState(("10.0.0.2",), ping=True, port="open")
NOW = 10_000.0
KEY = HostKey(f"ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAI{'A' * 43}")


@pytest.mark.parametrize(
    ("rule", "failing", "route"),
    [
        ("robot-not-found", "name bob.local", RouteState((), rule="unknown-host")),
        ("robot-silent", "answer to ping", RouteState(("10.0.0.2",), port="silent", rule="no-answer")),
        ("closed-ssh-port", "port 22", RouteState(("10.0.0.2",), ping=True, port="silent", rule="no-answer")),
        ("no-ssh-server", "port 22", RouteState(("10.0.0.2",), ping=True, port="refused", rule="no-ssh")),
        ("changed-host-key", "host key", RouteState(("10.0.0.2",), port="open", rule="changed-host-key")),
        ("unknown-host-key", "host key", RouteState(("10.0.0.2",), ping=True, port="open", rule="unknown-host-key")),
        ("key-refused", "login as ros", RouteState(("10.0.0.2",), ping=True, port="open", rule="refused")),
        (
            "no-login",
            "login as ros",
            RouteState(("10.0.0.2",), ping=True, port="open", rule="no-login", reason="closed"),
        ),
    ],
)
def test_step_that_fails_is_named_and_those_after_it_are_not_judged(rule: str, failing: str, route: RouteState) -> None:
    finding = explain_route(ADDRESS, route, None, RECORD, NOW)
    assert finding.rule == rule
    assert finding.help
    steps = list_steps(ADDRESS, route)
    bad = [index for index, step in enumerate(steps) if step.good is False]
    assert [steps[index].title for index in bad] == [failing]
    assert all(step.good is None for step in steps[bad[0] + 1 :])


def test_robot_that_is_away_was_last_seen_somewhere() -> None:
    finding = explain_route(ADDRESS, RouteState(()), SeenRobot("bob", "10.0.0.2", NOW - 7200.0), None, NOW)
    assert "10.0.0.2, 2 h ago" in finding.message


def test_another_host_key_is_renewed_by_hand_and_a_namesake_pointed_out() -> None:
    route = RouteState(("10.0.0.2",), True, "open", "changed-host-key", "", KEY, ("10.0.0.3",))
    finding = explain_route(ADDRESS, route, None, RECORD, NOW)
    assert KEY.fingerprint in finding.message
    assert "bob-2.local (10.0.0.3)" in finding.message
    assert "ur robot setup ros@bob.local --name bob --base magni --new-host-key" in finding.help
    assert not finding.fixable
    # The very key whose fingerprint is shown, not the one of whoever answers when the command is run.
    line = finding.commands[0].line
    assert line.startswith("ssh-keygen -R bob.local")
    assert f"echo 'bob.local,bob {KEY.key}' >>~/.ssh/known_hosts" in line
    assert "ssh-keyscan" not in line


def test_ping_that_is_not_installed_is_told_and_blamed_for_nothing() -> None:
    steps = list_steps(ADDRESS, RouteState(("10.0.0.2",), ping=None, port="silent", rule="no-answer"))
    assert [(step.good, step.seen) for step in steps[1:3]] == [
        (True, "not tried: ping is not installed"),
        (False, "no answer"),
    ]
