"""`ur robot setup` of several robots: each process gets all answers, and no secret on its command line."""

from ur.cli.robot_setup.robot import make_argv, setup
from ur.robot.setup.login import Task
from ur.robot.setup.robot_states import WantedRobot
from ur.robot.ssh.address import Address
from ur.robot.ssh.host_key import HostKey
from ur.robot.ssh.secret import Secret

KEY = HostKey(f"ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAI{'A' * 43}")


def parse(argv: list[str]) -> dict[str, object]:
    assert argv[:2] == ["robot", "setup"]
    return setup.make_context("setup", argv[2:]).params


def test_process_of_a_robot_gets_the_answers_of_that_robot() -> None:
    task = Task(
        Address("ubuntu", "10.0.0.7"),
        WantedRobot("eve", "magni", "lidar", programs=False, access_point=False),
        current=Secret("old-secret"),
        new=Secret("new-secret"),
        host_key=KEY,
        robot_login=True,
    )
    argv = make_argv(task, master=False, programs=True, new_host_key=True)
    assert "secret" not in " ".join(argv)
    given = parse(argv)
    assert given["hosts"] == ("ubuntu@10.0.0.7",)
    assert (given["name"], given["base"], given["variant"]) == ("eve", "magni", "lidar")
    assert given["host_key"] == KEY.fingerprint
    assert (given["master"], given["programs"], given["robot_login"]) == (False, False, True)
    assert (given["new_host_key"], given["one_of_several"], given["passwords_from"]) == (True, True, 0)
    assert (given["access_point"], "--access-point" in argv, "--no-access-point" in argv) == (False, False, True)


def test_known_robot_without_a_variant_is_asked_nothing() -> None:
    task = Task(Address("ros", "bob.local"), WantedRobot("bob", "magni"))
    given = parse(make_argv(task, master=True, programs=True, new_host_key=False))
    assert (given["variant"], given["host_key"], given["yes"]) == ("plain", None, False)
    assert (given["master"], given["programs"], given["robot_login"]) == (True, True, False)
