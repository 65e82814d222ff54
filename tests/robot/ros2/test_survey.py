"""The graph of real nodes, read by a program of its own, and what the doctor makes of it."""

import json
import os
import signal
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from tests.ros2_session import PYTHON, ROOT, Ros2Session

from ur.robot.doctor.rules import diagnose_alone
from ur.robot.doctor.side import Side
from ur.robot.ros2.seen_graph import Ros2, inspect_ros2, parse_ros2
from ur.robot.ssh.shell import LocalShell

SURVEY = ROOT / "src/ur_nodes/ros2/survey.py"
SETTLED = 7.0  # s, after which a survey of nodes that answer has ended
ROBOT = Path(__file__).with_name("faulty_robot.py")


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Ros2Session]:
    if not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    started = Ros2Session(tmp_path)
    yield started
    started.close()


@pytest.fixture
def halves(session: Ros2Session) -> Iterator[list[subprocess.Popen[bytes]]]:
    halves = [
        subprocess.Popen(
            [str(PYTHON), str(ROBOT), half], env=session.environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )
        for half in ("base", "laptop")
    ]
    try:
        for half in halves:
            assert half.stdout
            assert half.stdout.readline() == b"ready\n"
        yield halves
    finally:
        for half in halves:
            half.terminate()
        for half in halves:
            _end(half)


def _end(half: subprocess.Popen[bytes]) -> None:
    try:
        half.communicate(timeout=10)
    except subprocess.TimeoutExpired:  # of rclpy's own shutdown, now and then
        half.kill()
        half.communicate()


@pytest.mark.timeout(90)
@pytest.mark.usefixtures("halves")
def test_doctor_names_what_real_nodes_have_wrong(session: Ros2Session) -> None:
    done = session.run(str(SURVEY), within=60.0)
    assert done.returncode == 0, done.stderr
    graph = json.loads(done.stdout.splitlines()[-1])
    nothing: dict[str, object] = {name: [] for name in ("installations", "processes", "settings", "ports")}
    nothing |= {"no_multicast": [], "forgotten": [], "shell": {}, "called": {}, "files": {}, "problem": ""}
    ros2 = parse_ros2(json.dumps({**nothing, "graph": graph}))
    assert ros2.graph is not None
    assert {"/base", "/laptop"} <= set(ros2.graph.nodes)
    found = {each.rule: each for each in diagnose_alone(Side("bob", ros2=ros2), simulation=True)}
    assert set(found) == {"ros2-command-type", "ros2-qos", "ros2-no-clock", "ros2-low-battery"}
    assert "/laptop (Twist) publishes, and /base (TwistStamped) subscribes" in found["ros2-command-type"].message
    assert "/laptop never receives from /base" in found["ros2-qos"].message


@pytest.mark.timeout(90)
def test_survey_waits_for_a_node_that_answers_late(session: Ros2Session, halves: list[subprocess.Popen[bytes]]) -> None:
    late = halves[0]
    late.send_signal(signal.SIGSTOP)
    try:
        survey = subprocess.Popen([str(PYTHON), str(SURVEY)], env=session.environment, stdout=subprocess.PIPE)
        with pytest.raises(subprocess.TimeoutExpired):
            survey.wait(SETTLED)
    finally:
        late.send_signal(signal.SIGCONT)
    out, _ = survey.communicate(timeout=60)
    assert {"/base", "/laptop"} <= set(json.loads(out.splitlines()[-1])["nodes"])


@pytest.mark.timeout(90)
@pytest.mark.usefixtures("halves")
def test_running_nodes_are_found_with_their_domain(session: Ros2Session) -> None:
    found = inspect_ros2(LocalShell(), (), graph=False)
    domain = session.environment["ROS_DOMAIN_ID"]
    robots = [each for each in found.processes if str(ROBOT) in each.argv]  # those of tests that run beside, too
    ours = [each for each in robots if each.variables["ROS_DOMAIN_ID"] == domain]
    assert sorted(each.argv.split()[-1] for each in ours) == ["base", "laptop"]
    assert replace(found, processes=tuple(ours)).variables["ROS_DOMAIN_ID"] == domain


def test_computer_without_ros2_has_none() -> None:
    assert parse_ros2("{}") == Ros2()


@pytest.mark.parametrize("lie", ["", "null", "[1]", '{"installations": 3}', "[" * 100_000, '{"installations": [[]]}'])
def test_answer_that_makes_no_sense_is_no_ros2(lie: str) -> None:
    assert parse_ros2(lie) == Ros2()


def test_finder_needs_nothing_of_this_project() -> None:
    program = ROOT / "src/ur/robot/ros2/finder.py"
    request = json.dumps({"variables": [], "files": [], "graph": "", "environment": {}})
    environment = {"PATH": os.environ["PATH"]}
    done = subprocess.run(
        ["/usr/bin/python3", "-I", "-c", program.read_text()],
        input=request, capture_output=True, text=True, env=environment, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
