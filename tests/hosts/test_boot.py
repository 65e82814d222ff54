"""`ur boot`: what a robot starts by itself, after a reboot, with a late network, and when it keeps ending."""

import shutil
import sys
import sysconfig
from pathlib import Path

import pytest
from tests.hosts.bench import UR, Bench, Done, Machine
from tests.hosts.test_doctor import pair

__all__ = ["pair"]
TALK = 'rostopic pub -r 5 /words std_msgs/String "data: it\'s 100% \\$HOME"'
LIBRARY = "/home/ros/ubiquity_launches"
HEAR = "timeout 10 rostopic echo -n 1 /words"
PACKAGE = """\
<package format="2">
  <name>talkers</name><version>1.0.0</version><description>For a test.</description>
  <maintainer email="nobody@example.com">nobody</maintainer><license>MIT</license>
</package>
"""
LAUNCH = """\
<launch>
  <arg name="robot_base"/>
  <arg name="simulate" default="true"/>
  <arg name="more" default=""/>
  <node name="talk" pkg="rostopic" type="rostopic" output="screen"
    args="pub -r 5 /words std_msgs/String &quot;data: $(arg robot_base), simulated $(arg simulate), $(arg more)&quot;"/>
</launch>
"""


def boot(pair: Bench, words: str) -> Done:
    return pair["laptop"].run(f"{UR} boot {words}", user="pat", timeout=240)


@pytest.fixture
def empty(pair: Bench) -> Bench:
    """A robot that starts nothing by itself; the laptop has it selected."""
    pair["laptop"].run(f"{UR} use bob", user="pat").check()
    boot(pair, "remove").check()
    return pair


def bring_package(pair: Bench) -> None:
    laptop = pair["laptop"]
    for path, text in (("package.xml", PACKAGE), ("launch/talk.launch", LAUNCH)):
        line = f"mkdir -p catkin_ws/src/talkers/launch; cat >catkin_ws/src/talkers/{path}"
        laptop.run(line, user="pat", stdin=text).check()
    laptop.run(f"{UR} sync bob --yes", user="pat").check()


def reboot(pair: Bench) -> None:
    robot = pair["robot"]
    leader = robot.leader
    robot.run("systemctl reboot")
    robot.wait_rebooted(leader, deadline=180)


def test_program_runs_after_a_reboot_and_with_a_late_network(empty: Bench) -> None:
    laptop, robot = empty["laptop"], empty["robot"]
    boot(empty, f"install --name talk {TALK}").check()
    assert "nothing to do" in boot(empty, f"install --name talk {TALK}").check().out
    said = laptop.wait_for(HEAR, user="pat", deadline=120)
    assert "it's 100% $HOME" in said.out

    reboot(empty)
    laptop.wait_for(HEAR, user="pat", deadline=120)
    assert laptop.run("rosparam get /ur/base_name", user="pat").check().out.strip() == "magni"  # from its robot.yaml

    # Its address comes only later: as on a WiFi that takes its time.
    robot.run("sed -i s/^Address/#Address/ /etc/systemd/network/10-host0.network").check()
    reboot(empty)
    robot.wait_for("systemctl show -p SubState ubiquity-master | grep -q start-pre", deadline=120)
    robot.run("sed -i s/^#Address/Address/ /etc/systemd/network/10-host0.network; networkctl reload").check()
    laptop.wait_for(HEAR, user="pat", deadline=120)

    shown = boot(empty, "status").check().out
    assert "talk: runs since" in shown
    assert "master: runs since" in shown
    removed = boot(empty, "remove").check().out
    assert removed.count(": removed") == 2
    assert "nothing" in boot(empty, "status").check().out
    assert robot.run("pgrep -u ros -f roscore").code != 0


def test_launch_file_of_the_workspace_is_started_with_what_the_robot_knows(empty: Bench) -> None:
    laptop, robot = empty["laptop"], empty["robot"]
    missing = boot(empty, "install talkers talk.launch")
    assert missing.code == 2
    assert "ur sync bob" in missing.err
    bring_package(empty)
    boot(empty, "install talkers talk.launch 'more:=a b'").check()
    said = laptop.wait_for(HEAR, user="pat", deadline=120)
    assert "magni, simulated false, a b" in said.out.lower()

    # A new master: the program starts again and registers there.
    robot.run("pkill -KILL -u ros -f '[r]osmaster'").check()
    laptop.wait_for(HEAR, user="pat", deadline=120)
    assert "talk: runs" in boot(empty, "status").check().out
    wrong = boot(empty, "install talkers talk.launch mroe:=1")
    assert (wrong.code, "no argument 'mroe'" in wrong.err) == (2, True)


def test_library_is_brought_along_and_has_to_be_set_up_there(empty: Bench) -> None:
    robot = empty["robot"]
    done = boot(empty, "install robot_base")
    assert done.code == 2
    assert "is there and not set up" in done.err
    assert "ur robot setup bob completes it" in done.err
    assert "nothing" in boot(empty, "status").out
    found = robot.run(
        "/usr/bin/python3 -c 'import rospkg; print(rospkg.RosPack().get_path(\"ubiquity_launches\"))'; command -v ur",
        user="ros",
    )
    package = f"{LIBRARY}/ubiquity_launches"
    assert found.out.split() == [package, f"{package}/bin/ur"]
    # Without the internet it cannot be set up, and says so.
    first = robot.run("ubiquity_launches/ur --version", user="ros", timeout=120)
    assert first.code == 2
    assert "error: " in first.err
    assert "help: " in first.err
    assert "Traceback" not in first.err


def test_launch_file_is_started_by_ur_where_it_is_set_up(empty: Bench) -> None:
    laptop, robot = empty["laptop"], empty["robot"]
    bring_package(empty)
    boot(empty, "install robot_base")  # brings the library
    set_up_library(robot)
    assert "needs the terminal" in boot(empty, "install keyboard_drive").err
    boot(empty, "install talkers talk.launch").check()
    said = laptop.wait_for(HEAR, user="pat", deadline=120)
    assert "magni, simulated false" in said.out
    assert robot.run("pgrep -u ros -f '[m] ur launch --plain --wait talkers'").code == 0
    boot(empty, "remove talk").check()
    assert robot.run("pgrep -u ros -f 'rostopic pub'").code != 0


def set_up_library(robot: Machine) -> None:
    """As `ur` does it with the internet, with what it takes for a launch file: the bench has none."""
    make = f"python3 -m venv --system-site-packages --without-pip {LIBRARY}/.venv"
    find = f"{LIBRARY}/.venv/bin/python -c 'import sysconfig; print(sysconfig.get_path(\"purelib\"))'"
    place = robot.run(f"{make} && {find}", user="ros").check().out.strip()
    for name in ("click", "rich_click", "rich", "pygments", "msgspec"):
        own = Path(sysconfig.get_path("purelib")) / name
        if own.is_dir():
            target = robot.root / place.lstrip("/") / name
            shutil.copytree(own, target, ignore=shutil.ignore_patterns("__pycache__"), dirs_exist_ok=True)
    robot.write(f"{place}/ubiquity.pth", f"{LIBRARY}/src\n")
    robot.write(f"{LIBRARY}/.venv/ready-run", f"{LIBRARY}\n")


def test_program_that_keeps_ending_pauses_longer_and_longer_and_is_told(empty: Bench) -> None:
    robot = empty["robot"]
    boot(empty, "install --name failing ls /nowhere").check()
    robot.wait_for("journalctl -q -u ubiquity-failing -o cat | grep -q 'next start is in 8 s'", deadline=120)
    done = boot(empty, "status")
    assert done.code == 1
    assert "failing: " in done.out
    assert "/nowhere" in done.out
    log = robot.run("journalctl -q -u ubiquity-failing -o cat").out
    pauses = [line.rpartition(" in ")[2] for line in log.splitlines() if "next start is in" in line]
    assert pauses[:3] == ["2 s", "4 s", "8 s"]
    sys.stdout.write(f"pauses of a program that keeps ending: 0 s, {', '.join(pauses)}\n")


def test_what_the_robot_does_not_have_is_refused(empty: Bench) -> None:
    done = boot(empty, "install no_such_command")
    assert done.code == 2
    assert "no command there" in done.err
    assert "nothing" in boot(empty, "status").out
