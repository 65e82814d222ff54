"""A program whose nodes run on two computers: started on the laptop, the robot's part on the robot."""

from __future__ import annotations

import json
import re
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from tests.hosts.bench import REPOSITORY, UR, Bench, Machine, boot, wait_until
from tests.hosts.test_robot_setup import prepare, set_up
from tests.hosts.test_x import SCREEN, XVFB
from tests.hosts.test_x import started as running

PACKAGE = """\
<package format="2">
  <name>chat</name><version>1.0.0</version><description>For a test.</description>
  <maintainer email="nobody@example.com">nobody</maintainer><license>MIT</license>
</package>
"""
LAUNCH = """\
<launch>
  <arg name="robot_machine" default="localhost"/>
  <arg name="viewer_machine" default="localhost"/>
  <arg name="simulate" default="true"/>
  <arg name="text" default="hello"/>
  <machine name="localhost" address="localhost"/>
  <param name="shared" value="$(arg text)"/>
  <node machine="$(arg robot_machine)" name="talk" pkg="chat" type="talk.py" clear_params="true">
    <param name="text" value="$(arg text), simulated $(arg simulate)"/>
  </node>
  <node machine="$(arg viewer_machine)" name="hear" pkg="chat" type="hear.py" output="screen" clear_params="true">
    <param name="own" value="1"/>
  </node>
</launch>
"""
ONLY_THERE = """\
<launch>
  <arg name="robot_machine" default="localhost"/>
  <machine name="localhost" address="localhost"/>
  <node machine="$(arg robot_machine)" name="alone" pkg="chat" type="talk.py" output="screen">
    <param name="text" value="alone"/>
  </node>
</launch>
"""
TALK = """\
#!/usr/bin/python3
import socket
import rospy
from std_msgs.msg import String
rospy.init_node("talk")
text = rospy.get_param("~text") + ", " + rospy.get_param("/shared", "") + " from " + socket.gethostname()
out = rospy.Publisher("words", String, queue_size=1, latch=True)
number = 0
while not rospy.is_shutdown():
    number += 1
    print("it says " + text, flush=True)
    out.publish("%d: %s" % (number, text))
    try:
        rospy.sleep(0.2)
    except rospy.ROSInterruptException:
        break
"""
HEAR = """\
#!/usr/bin/python3
import socket
import rospy
from std_msgs.msg import String
rospy.init_node("hear")
rospy.Subscriber("words", String, lambda word: print(socket.gethostname() + " heard " + word.data, flush=True))
rospy.spin()
"""
FILES = {
    "package.xml": (PACKAGE, 0o644),
    "launch/chat.launch": (LAUNCH, 0o644),
    "launch/alone.launch": (ONLY_THERE, 0o644),
    "launch/listen.launch": (LAUNCH.replace('name="hear"', 'name="listen"'), 0o644),
    "scripts/talk.py": (TALK, 0o755),
    "scripts/hear.py": (HEAR, 0o755),
}
USERS = {"laptop": "pat", "laptop2": "pat", "robot": "ros"}


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    """A laptop, and a robot `bob` with a master and this project; both have the package `chat`."""
    with boot(("laptop", "robot"), with_repository=("laptop", "robot")) as bench:
        prepare(bench["laptop"])
        set_up(bench["laptop"]).check()
        link_project(bench["robot"])
        for machine in (bench["laptop"], bench["robot"]):
            bring_package(machine)
        bench["laptop"].run(f"{UR} use bob", user="pat").check()
        bench["laptop"].wait_for("rosnode list", user="pat", deadline=120)
        yield bench


def link_project(robot: Machine) -> None:
    """Replace the robot's copy of this project by a link to this repository, whose environment is ready to run."""
    robot.run(f"rm -rf ubiquity_launches && ln -s {REPOSITORY} ubiquity_launches", user="ros").check()


def bring_package(machine: Machine) -> None:
    user = USERS[machine.name]
    for name, (text, mode) in FILES.items():
        machine.write(f"/home/{user}/catkin_ws/src/chat/{name}", text, mode=mode)
    machine.run(f"chown -R {user}:{user} /home/{user}/catkin_ws/src/chat").check()


class Started:
    """A program that was started on the laptop, with what it says so far."""

    def __init__(self, laptop: Machine, words: str, log: Path) -> None:
        self._laptop = laptop
        self._log = log
        with log.open("wb") as output:
            self.process = subprocess.Popen(
                laptop.command_line(f"exec {UR} {words}", user="pat"),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    @property
    def said(self) -> str:
        return self._log.read_text(errors="replace")

    def wait_said(self, pattern: str, *, after: int = 0, deadline: float = 60.0) -> None:
        """Wait until it has said what a pattern fits, after so many characters."""

        def has_said() -> bool:
            ended = self.process.poll() is not None
            found = re.search(pattern, self.said[after:]) is not None
            assert found or not ended, self.said
            return found

        try:
            wait_until(has_said, f"{pattern!r} is said", deadline)
        except AssertionError as problem:
            raise AssertionError(f"{problem}\n{self.said[-5000:]}") from None

    def signal(self, number: signal.Signals) -> None:
        """Send a signal to `ur launch` itself, inside."""
        self._laptop.run(f"pkill -{number.value} -u pat -f '^[^ ]*python.* -m ur launch'").check()

    def end(self) -> None:
        """End it as Ctrl-C does."""
        self.signal(signal.SIGINT)
        assert self.process.wait(60) == 0, self.said


@contextmanager
def started(pair: Bench, words: str, tmp_path: Path, laptop: str = "laptop") -> Iterator[Started]:
    found = Started(pair[laptop], words, tmp_path / f"said{len(list(tmp_path.iterdir()))}")
    try:
        yield found
    finally:
        if found.process.poll() is None:
            pair[laptop].run("pkill -KILL -u pat -f '^[^ ]*python -I -m ur launch'")
        found.process.wait(60)


@pytest.fixture(autouse=True)
def clean(pair: Bench) -> Iterator[None]:
    yield
    pair["laptop"].restore()
    pair["robot"].restore()
    pair["robot"].run("bash -lc 'ur stop --all'", user="ros")


def nodes_of(machine: Machine) -> list[str]:
    """The nodes of the package that run on a computer."""
    return sorted(
        name
        for _, words in machine.processes()
        for name in ("talk.py", "hear.py")
        if f"chat/scripts/{name}" in words and words.startswith("/usr/bin/python3")
    )


def runs_there(pair: Bench) -> list[str]:
    done = pair["laptop"].run(f"{UR} shell bob ur ps", user="pat").check()
    return [line.split()[0] for line in done.out.splitlines()[1:]]


def test_each_node_runs_on_its_computer_and_ctrl_c_leaves_nothing_on_either(pair: Bench, tmp_path: Path) -> None:
    with started(pair, "launch chat chat.launch 'text:=a  b'", tmp_path) as program:
        program.wait_said("laptop heard ")
        assert "a  b, simulated false, a  b from bob" in program.said
        assert "bob: 1 node, run chat." in program.said
        assert (nodes_of(pair["laptop"]), nodes_of(pair["robot"])) == (["hear.py"], ["talk.py"])
        assert len(runs_there(pair)) == 1
        program.signal(signal.SIGINT)
        assert program.process.wait(60) == 0, program.said
    assert "has ended" in program.said
    assert (nodes_of(pair["laptop"]), nodes_of(pair["robot"])) == ([], [])
    assert runs_there(pair) == []


def test_run_of_the_robot_outlives_the_laptops_and_is_taken_over(pair: Bench, tmp_path: Path) -> None:
    with started(pair, "launch chat chat.launch", tmp_path) as program:
        program.wait_said("laptop heard ")
        (before,) = runs_there(pair)
        program.signal(signal.SIGKILL)
        program.process.wait(60)
    wait_until(lambda: nodes_of(pair["laptop"]) == [], "nothing is left on the laptop", 60)
    assert runs_there(pair) == [before]
    assert nodes_of(pair["robot"]) == ["talk.py"]
    with started(pair, "launch chat chat.launch", tmp_path) as program:
        program.wait_said("laptop heard ")
        assert "is taken over" in program.said
        assert runs_there(pair) == [before]
        assert nodes_of(pair["robot"]) == ["talk.py"]
        program.signal(signal.SIGINT)
        assert program.process.wait(60) == 0, program.said
    assert runs_there(pair) == []
    assert nodes_of(pair["robot"]) == []


def test_network_that_is_cut_and_restored_loses_nothing(pair: Bench, tmp_path: Path) -> None:
    with started(pair, "launch chat chat.launch", tmp_path) as program:
        program.wait_said("laptop heard ")
        before = runs_there(pair)
        pair["laptop"].cut()
        ping = f"ping -c 1 -W 1 {pair['robot'].address}"
        wait_until(lambda: pair["laptop"].run(ping).code != 0, "the robot is away", 60)
        pair["laptop"].restore()
        pair["laptop"].wait_for(ping, deadline=60)
        program.wait_said("laptop heard ", after=len(program.said))
        assert runs_there(pair) == before
        assert nodes_of(pair["robot"]) == ["talk.py"]
        program.signal(signal.SIGINT)
        assert program.process.wait(60) == 0, program.said
    assert runs_there(pair) == []


def test_node_that_runs_there_already_is_left_alone(pair: Bench, tmp_path: Path) -> None:
    robot = pair["robot"]
    robot.run("bash -lc 'ur launch --detach --wait --only talk chat chat.launch text:=own'", user="ros").check()
    before = runs_there(pair)
    with started(pair, "launch chat chat.launch", tmp_path) as program:
        program.wait_said("laptop heard ")
        assert "bob: 1 node runs already: /talk" in program.said
        assert "own, simulated true" in program.said
        program.signal(signal.SIGINT)
        assert program.process.wait(60) == 0, program.said
    assert runs_there(pair) == before
    assert nodes_of(robot) == ["talk.py"]


def test_second_program_of_the_laptop_joins_and_the_robot_serves_it_when_the_first_has_ended(
    pair: Bench, tmp_path: Path
) -> None:
    with started(pair, "launch chat chat.launch", tmp_path) as one:
        one.wait_said("laptop heard ")
        (run,) = runs_there(pair)
        with started(pair, "launch chat listen.launch", tmp_path) as two:
            two.wait_said("laptop heard ")
            assert "bob: 1 node runs already: /talk" in two.said
            assert nodes_of(pair["robot"]) == ["talk.py"]
            pair["laptop"].run("pkill -INT -u pat -f 'm ur launch chat chat.launch'").check()
            assert one.process.wait(90) == 0, one.said
            assert f"bob: {run} goes on for laptop" in one.said
            two.wait_said("laptop heard ", after=len(two.said))
            two.signal(signal.SIGINT)
            assert two.process.wait(90) == 0, two.said
    assert runs_there(pair) == []
    assert nodes_of(pair["robot"]) == []


def test_program_of_the_robot_alone_is_followed_through_a_lost_connection(pair: Bench, tmp_path: Path) -> None:
    with started(pair, "launch chat alone.launch", tmp_path) as program:
        program.wait_said("it says alone")
        assert len(runs_there(pair)) == 1
        pair["laptop"].cut()
        program.wait_said("connection lost")
        at = len(program.said)
        pair["laptop"].restore()
        program.wait_said("it says alone", after=at)
        program.signal(signal.SIGINT)
        assert program.process.wait(60) == 0, program.said
    assert runs_there(pair) == []
    assert nodes_of(pair["robot"]) == []


def test_what_the_robot_lacks_is_said_in_one_line(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    robot.run("mv catkin_ws/src/chat chat", user="ros").check()
    try:
        done = laptop.run(f"{UR} launch chat chat.launch", user="pat", timeout=120)
        assert done.code != 0
        assert "error: bob: no package or file named 'chat'" in done.err
        assert "ur sync bob" in done.err
    finally:
        robot.run("mv chat catkin_ws/src/chat", user="ros").check()
    robot.run("mv ubiquity_launches elsewhere", user="ros").check()
    try:
        done = laptop.run(f"{UR} launch chat chat.launch", user="pat", timeout=120)
        assert done.code != 0
        assert "bob: ubiquity_launches is not there" in done.err
    finally:
        robot.run("mv elsewhere ubiquity_launches", user="ros").check()
    laptop.run("cp catkin_ws/src/chat/launch/chat.launch .", user="pat").check()
    done = laptop.run(f"{UR} launch chat.launch", user="pat", timeout=120)
    assert done.code != 0
    assert "expected a launch file of a package" in done.err


def test_debugger_of_a_node_on_the_robot_has_a_window_on_the_laptop(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    robot.run("apt-get install -y xterm python3-pudb", timeout=300).check()
    with running(laptop, XVFB, "pat"):
        laptop.wait_for("[ -S /tmp/.X11-unix/X7 ]", deadline=60)
        line = f"env DISPLAY=:7 {UR} shell -X bob ubiquity_launches/ur launch --debug alone chat alone.launch"
        with running(laptop, line, "pat"):
            laptop.wait_for("xwd -silent -name /alone >w", user="pat", environment=SCREEN, deadline=120)
            robot.wait_for("pgrep -u ros -f 'pudb .*talk.py'", deadline=60)
        # The window is closed with `ur shell -X`, and the node ends with it.
        robot.wait_for("! pgrep -u ros -f talk.py", deadline=60)


def test_assistant_on_the_laptop_is_served_by_the_robot_over_ssh(pair: Bench) -> None:
    line = "exec ssh -o BatchMode=yes ros@bob.local ubiquity_launches/ur mcp"
    pipe = subprocess.PIPE
    with subprocess.Popen(
        pair["laptop"].command_line(line, user="pat"), stdin=pipe, stdout=pipe, text=True
    ) as assistant:
        answers = assistant.stdout
        assert assistant.stdin is not None
        assert answers is not None

        def ask(method: str, **params: object) -> dict[str, Any]:
            message = {"jsonrpc": "2.0", "id": 1, "method": method, "params": params}
            print(json.dumps(message), file=assistant.stdin, flush=True)
            found: dict[str, Any] = json.loads(answers.readline())
            return found

        try:
            refused = ask("server/discover", _meta={"io.modelcontextprotocol/protocolVersion": "2026-07-28"})
            assert "error" in refused, "a version without signs of life"
            client = {"name": "Ada's helper", "version": "1"}
            ask("initialize", protocolVersion="2025-06-18", capabilities={}, clientInfo=client)
            print('{"jsonrpc": "2.0", "method": "notifications/initialized"}', file=assistant.stdin, flush=True)
            assert "go_to" in {each["name"] for each in ask("tools/list")["result"]["tools"]}
            assert (
                "grant" in ask("tools/call", name="drive", arguments={"forward": 0.1})["result"]["content"][0]["text"]
            )
            assert "Ada's helper" in pair["robot"].run("ubiquity_launches/ur mcp list", user="ros").check().out
        finally:
            assistant.stdin.close()
            assistant.wait(60)
