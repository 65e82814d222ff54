"""The same launch file through roslaunch and `ur launch`: nodes and the parameter server must not see a difference."""

import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from tests.forking import ForkingPython, python_of_ros, python_of_ur
from tests.run.test_launch import ask_master

from ur.request.environment import current_selection, environment_changes

ROSLAUNCH = Path("/usr/bin/roslaunch")
RECORD = """#!/usr/bin/python3
import json, os, sys, time
name = next(word[8:] for word in sys.argv if word.startswith("__name:="))
path = os.path.join(os.environ["RECORDS"], name)
with open(path + ".new", "w") as file:
    json.dump({"argv": sys.argv, "cwd": os.getcwd(), "env": dict(os.environ), "signals": [
        int(line.split()[1], 16) & 0x7fffffff
        for line in open("/proc/self/status") if line.startswith(("SigIgn", "SigBlk"))],
        "umask": oct(os.umask(0)), "leader": os.getpgid(0) == os.getpid(), "stdin": os.readlink("/proc/self/fd/0"),
        "descriptors": sorted(map(int, os.listdir("/proc/self/fd")))[:4]}, file)
os.rename(path + ".new", path)
time.sleep(600)
"""
PLAIN = '<node pkg="little_nodes" type="record" name="a"/>'
FILES = {
    "plain": PLAIN,
    "arguments": '<node pkg="little_nodes" type="record" name="a" ns="deep/er"'
    " args=\"one 'two  words' &quot;3&quot; _p:=4\">"
    '<remap from="in" to="/out"/><remap from="x" to="y"/><param name="q" value="1"/></node>',
    "environment": '<env name="ALL" value="every one"/><group ns="g"><env name="GROUP" value="$(env HOME)"/>'
    '<node pkg="little_nodes" type="record" name="a"><env name="MINE" value=""/></node></group>'
    '<node pkg="little_nodes" type="record" name="b"/>',
    "folders": '<node pkg="little_nodes" type="record" name="a" cwd="node"/>'
    '<node pkg="little_nodes" type="record" name="b" cwd="ROS_HOME"/>'
    '<node pkg="little_nodes" type="record" name="c" launch-prefix="env PREFIXED=1" output="screen"/>'
    '<node pkg="little_nodes" type="record" name="d" launch-prefix="/usr/bin/nice -n 1" cwd="node"/>',
    "parameters": PLAIN + '<param name="i" value="1"/><param name="f" value="1.5"/><param name="s" value="text &lt;"/>'
    '<param name="b" value="true"/><param name="t" type="str" value="7"/><param name="n" type="double" value="3"/>'
    '<param name="c" command="printf \'%s\' 12"/>'
    "<rosparam>{list: [1, two, 3.0], deep: {er: {x: -1, e: 1.0e-3}}}</rosparam>"
    '<group ns="robot"><rosparam param="gains">[0.1, 0.2]</rosparam><param name="~p" value="private"/>'
    '<node pkg="little_nodes" type="record" name="b"><rosparam>{own: {k: v}}</rosparam></node></group>',
}
# What is about the run itself: its log folder, and under which address roslaunch could be asked.
_RUN = re.compile(r"/log/[0-9a-f-]{36}/")
_OWN_PARAMETERS = ("run_id", "roslaunch")
_OWN_VARIABLES = ("_", "SHLVL", "OLDPWD", "ROS_LOG_FILENAME")  # the last one is roslaunch's own log file

pytestmark = [pytest.mark.ros, pytest.mark.skipif(not ROSLAUNCH.exists(), reason="roslaunch is not installed")]


def observe(
    world: Any, python: ForkingPython, command: tuple[str, ...], count: int
) -> tuple[dict[str, Any], dict[str, Any], set[str]]:
    """Start, and tell what so many nodes see, which parameters there are, and which log files nodes print to."""
    records = world.folder / "records"
    records.mkdir(exist_ok=True)
    for old in records.iterdir():
        old.unlink()
    for old in world.folder.glob("ros/log/*/*-std*.log"):
        old.unlink()
    if world.master_pid:
        ask_master(world.port, "deleteParam", "/")
    environment = {**world.environment, "RECORDS": str(records)}
    silent = (subprocess.DEVNULL, subprocess.DEVNULL, subprocess.DEVNULL)
    process = python.start(*command, folder=world.folder, environment=environment, streams=silent)
    try:
        end = time.monotonic() + 60
        while len(found := [path for path in records.iterdir() if path.suffix != ".new"]) < count:
            assert time.monotonic() < end
            assert process.poll() is None
            time.sleep(0.02)
        seen = {path.name: json.loads(_RUN.sub("/log/RUN/", path.read_text())) for path in found}
        parameters = ask_master(world.port, "getParam", "/")
        run_id = parameters["run_id"]
        logs = {path.name for path in (world.folder / "ros/log" / run_id).glob("*-std*.log")}
        assert os.path.realpath(world.folder / "ros/log/latest").endswith(run_id)
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(60)
    return seen, {name: value for name, value in parameters.items() if name not in _OWN_PARAMETERS}, logs


def find_differences(ours: dict[str, Any], theirs: dict[str, Any]) -> dict[str, Any]:
    """What a node sees in another way, by name, the variables of its environment one by one."""
    one, other = ({**record, **record["env"], "env": None} for record in (ours, theirs))
    names = (one.keys() | other.keys()).difference(_OWN_VARIABLES)
    return {name: (one.get(name), other.get(name)) for name in names if one.get(name) != other.get(name)}


@pytest.mark.usefixtures("master")
@pytest.mark.parametrize("name", FILES)
def test_nodes_and_parameters_are_those_of_roslaunch(world: Any, name: str) -> None:
    node = world.folder / "little_nodes/nodes/record"
    node.write_text(RECORD)
    node.chmod(0o755)
    file = world.write(FILES[name])
    count = FILES[name].count("<node ")
    world.environment |= environment_changes(current_selection(world.environment), world.environment)  # as in a shell
    theirs = observe(world, python_of_ros(), (str(ROSLAUNCH), file), count)
    ours = observe(world, python_of_ur(), ("ur", "launch", file), count)
    for node_name, record in theirs[0].items():
        assert find_differences(ours[0][node_name], record) == {}
    assert ours[1] == theirs[1]
    assert ours[2] >= theirs[2]  # and those of nodes on the screen


def test_master_of_its_own_holds_what_roscore_puts_there(world: Any) -> None:
    node = world.folder / "little_nodes/nodes/record"
    node.write_text(RECORD)
    node.chmod(0o755)
    file = world.write(FILES["plain"])
    _, theirs, their_logs = observe(world, python_of_ros(), (str(ROSLAUNCH), file), 1)
    _, ours, our_logs = observe(world, python_of_ur(), ("ur", "launch", file), 1)
    assert ours.pop("ur")  # which base it is
    assert ours == theirs
    assert our_logs >= their_logs
