"""Wrong inputs of every verb, and what `ur` prints for them: the golden file messages.txt is made from this."""

from __future__ import annotations

import io
import os
import re
import shlex
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

import click

from ur.cli.main import main
from ur.cli.verbs import VERBS, load_verb

GOLDEN = Path(__file__).with_name("messages.txt")
LIBRARY = Path(__file__).parents[2] / "ubiquity_launches"
TALKER = '<launch>\n  <node name="talker" pkg="demo" type="talker"/>\n</launch>\n'
SPEED = '<launch>\n  <arg name="speed"/>\n  <param name="v" value="$(arg speed)"/>\n</launch>\n'
FILES: Mapping[str, str] = {
    "src/demo/package.xml": "<package>\n  <name>demo</name>\n</package>\n",
    "src/demo/launch/talker.launch": TALKER,
    "src/demo/launch/twice.launch": TALKER,
    "src/demo/other/twice.launch": TALKER,
    "src/demo/launch/speed.launch": SPEED,
    "src/demo/bin/talker": "#!/bin/sh\nexit 0\n",
    "empty.launch": "",
    "text.launch": "this is no XML\n",
    "ros2.launch": '<launch>\n  <let name="speed" value="1"/>\n</launch>\n',
    "ros2.launch.py": "def generate_launch_description():\n    pass\n",
    "missing.launch": '<launch>\n  <include file="$(find demo)/launch/talkr.launch"/>\n</launch>\n',
    "package.launch": '<launch>\n  <include file="$(find dmeo)/launch/talker.launch"/>\n</launch>\n',
    "node.launch": '<launch>\n  <node name="talker" pkg="demo" type="tlker"/>\n</launch>\n',
    "machine.launch": '<launch>\n  <node name="talker" pkg="demo" type="talker" machine="robto"/>\n</launch>\n',
    "notes.txt": "buy a battery\n",
    "robots.yaml": "robots: 3\n",
    "list.yaml": "- a\n- b\n",
    "picture.png": "no picture\n",
}

# One command line each; what has an effect beyond this folder is not among them.
LINES = """
lanch
xyzzy
topic list
node list
service list
param set a b
bag record
rosrun demo talker
roscore
rviz
status
update
install demo
rename bob
world
world=office
commit
drive
goto 2 3
ssh bob
explore
maps join a b
maps ls
maps rm a
launch ubiquity_launches m_robot_base.launch.xml x:=abc
launch ubiquity_launches m_robot_base.launch.xml office
launch ubiquity_launches m_robot_base.launch.xml world=office
launch ubiquity_launches m_robot_base.launch.xml --world office
launch ubiquity_launches m_make_map.launch.xml explore:=yes map:=x
launch ubiquity_launches m_robot_base.launch.xml robot_base:=turtlebot4
use sim:turtlebot4
keyboard_driv
empty.launch
--versoin
help lst
run keyboard_navigat
run ../ur
run src/demo/launch/talker.launch
launch ubiquity_launches m_robot_base.launch.xml simulate:=flase
launch ubiquity_launches m_robot_base.launch.xml bring_up:=on
launch nothing.launch
launch empty
launch demo
launch demo talkr.launch
launch demo twice.launch
launch dmeo talker.launch
launch src/demo/launch/talkr.launch
launch empty.launch
launch text.launch
launch notes.txt
launch ros2.launch
launch ros2.launch.py
launch missing.launch
launch package.launch
launch machine.launch
launch demo speed.launch
launch demo speed.launch sped:=1
launch demo speed.launch speed
launch demo speed.launch 1:=2
launch --nodes nothing.launch
launch --nodes text.launch
launch --find-node talkr demo talker.launch
launch --args talkr demo talker.launch
launch --ros-args nothing.launch
launch --files nothing.launch
launch --dump-params nothing.launch
launch --wait --port 0 demo talker.launch
launch ubiquity_launches m_robot_base.launch.xml robot_base:=mangi
ps --ended more
attach nobody
replay
replay absent.mcap
replay notes.txt --info
record x:=1
replay --pause
replay notes.txt --pause
replay notes.txt nobody
replay notes.txt keyboard_navigate fast
logs
logs talker
logs talker --run nothing
report nothing
restart talker
restart talker --run nothing
wait
wait nothing
stop
stop nothing
stop --node talker
stop nothing --all
check nothing.launch
check notes.txt
check empty
check empty.launch
check text.launch
check ros2.launch
check ros2.launch.py
check node.launch
check --select bad-xlm
check --ignore valeus
check --explain bad-xlm
check src/demo/launch/speed.launch sped:=1
check list.yaml picture.png
package nothing
package notes.txt
package empty
format nothing.launch
format notes.txt
format text.launch
format ros2.launch
find talker nothing
find nobody src/demo
docs nothing
docs empty
docs notes.txt --output -
graph nothing.launch
graph demo talkr.launch
graph text.launch
graph demo talker.launch --as png
graph --live
graph demo talker.launch --output picture.gif
explain talker
explain nothing.launch speed
explain demo speed.launch spede
explain demo speed.launch speed
use mangi
use sim:mangi
use sim:magni:lidra
use a:b:c:d
use 'a b'
use robot.example.org
web nosuchrobot
web sim:mangi
web --end nothing
web --days never
debian install
setup --undo --dry-run more
robots 'a b'
shell
shell --nonsense
shell 'a b'
shell -- -oProxyCommand=x
x --nonsense word
x 'a b' word
x -- -oProxyCommand=x word
sync 'a b'
sync --all
sync --to --from carrot
sync
build
build 'a b'
build --all
build --all bob
mount
mount 'a b'
unmount nobody
unmount 'a b'
doctor 'a b'
doctor bob,'e e'
wifi 'a b'
get
get 'a b'
get speed:=1
get --undo rviz
get --missing nowhere/at/all
devices bob
devices --robot 'a b'
devices --rules --base mangi
devices --rules --base magni --variant ldar
robot setup
robot setup 'a b'
robot setup --all
robot setup --all bob
robot setup --from nothing.yaml
robot setup --from robots.yaml
robot setup --from list.yaml
robot setup --base mangi carrot
robot setup --name 'a b' carrot
robot setup --name a carrot parsnip
robot setup --variant lidra --base magni carrot
robot rename carrot 'a b'
robot rename 'a b' carrot
robot rename carrot carrot
robot wifi 'a b'
robot wifi --ssid home --forget home carrot
robot wifi --band 5 carrot
robot wheels 'a b'
robot wheels --here carrot
robot wheels --base create2 carrot
robot wheels --here --base create3
robot network 'a b'
robot network --address 300.1.1.1/24 carrot
robot network --address 192.168.1.7 carrot
robot network --address 192.168.1.7/24 --dhcp carrot
robot network --gateway 192.168.1.1 carrot
robot network --dns one carrot
image prepare nothing.img
image prepare notes.txt
image prepare --name 'a b' notes.txt
image prepare --name carrot notes.txt
image prepare --name carrot --base mangi notes.txt
image prepare --from nothing.yaml notes.txt
image prepare --from robots.yaml notes.txt
image prepare --country Germany --name carrot notes.txt
image prepare --undo notes.txt
image prepare empty
boot install
boot install --nonsense
boot install nothing
boot install demo talkr.launch
boot install demo speed.launch
boot install demo speed.launch sped:=1
boot install --name 'a b' demo talker.launch
boot log nothing
boot remove nothing
boot status --all
boot remove
maps show nothing
maps import nothing.yaml
maps copy flat
maps rename nothing a/b
maps edit nothing rotate
maps export nothing out
new node 1st --from-package demo --type talker --no-look
new node talker --package src/demo --from-package dmeo --type talker --no-look
new node talker --package src/demo --from-package demo --type tlker --no-look
new node talker --package src/demo --no-look
new multi all --package src/demo
new multi all --package src/demo --include nothing
new multi 1st --include talker
new rviz map --package src/demo --topic scan
new rviz 1st
new program drive
new program drive --package src/demo
new program drive --package nothing --launch talker.launch
new program drive --package src/demo --launch nothing.launch
new base mangi --package src/demo --like nothing
new base 1st
new base small --package src/demo --mass -1
new base small --package src/demo --width 0 --length 0.3
new base small --package src/demo --from nothing.urdf
new base small --package src/demo --from picture.png
new base small --package src/demo --from src/demo/package.xml
new base small --package src/demo --from src/demo/package.xml --lidar
new base small --package src/demo --workspace own
new base small --package src/demo --driver mangi
new package 1st
new package Demo
new package demo
new node talker --package src/demo --summary Talk. --from-package dmeo --type talker --no-look
new node talker --package src/demo --summary Talk. --from-package demo --type tlker --no-look
new multi all --package src/demo --summary Talk. --include nothing
new base small --package src/demo --summary Talk. --mass -1
new package nose --summary Talk. --email nobody
new script Look
new world a/b --size 8x6
new world office
new world office --size big
new world office --size 0x6
new world office --size 8x6 --picture picture.png
new world office --picture nothing.png
new world office --picture picture.png --width 10
new world office --size 8x6 --cell 0
""".strip().splitlines()


def list_lines() -> list[list[str]]:
    """Every command line: those that follow from the options and arguments of each command, then those of LINES."""
    derived = [line for path, command in list_commands() for line in _derive(path, command)]
    return [*derived, *map(shlex.split, LINES)]


def list_commands() -> Iterator[tuple[list[str], click.Command]]:
    """Every verb and its subcommands, with the words that call it."""
    for verb in VERBS:
        command = load_verb(verb)
        yield [verb], command
        if isinstance(command, click.Group):
            yield from (([verb, name], each) for name, each in command.commands.items())


def _derive(path: list[str], command: click.Command) -> Iterator[list[str]]:
    if isinstance(command, click.Group):
        yield [*path, "nonsense"]
        return
    if not command.context_settings.get("ignore_unknown_options"):
        yield [*path, "--nonsense"]
    arguments = [each for each in command.params if isinstance(each, click.Argument)]
    if any(each.required for each in arguments):
        yield path
    if all(each.nargs == 1 for each in arguments):
        yield [*path, *("word" for _ in arguments), "more"]
    options = [
        each for each in command.params if isinstance(each, click.Option) and not each.is_flag and not each.count
    ]
    if options:
        yield [*path, max(options[0].opts, key=len)]
    for each in options:
        option = max(each.opts, key=len)
        if isinstance(each.type, click.Choice | click.types.IntParamType | click.types.FloatParamType):
            yield [*path, option, "wrong"]
        if isinstance(each.type, click.IntRange | click.FloatRange) and each.type.min is not None:
            yield [*path, option, "-1"]


def describe_messages() -> str:
    """The golden text: each command line, its exit code and what it prints."""
    with tempfile.TemporaryDirectory() as folder, enter_folder(Path(folder)):
        return "".join(describe(words, folder) for words in list_lines())


@contextmanager
def enter_folder(folder: Path) -> Iterator[None]:
    """Make a folder with FILES the working folder and home, and know nothing else of this computer."""
    for name, text in FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    (folder / "src/demo/bin/talker").chmod(0o755)
    (folder / "empty").mkdir()
    (folder / "runtime").mkdir(mode=0o700)
    before = Path.cwd()
    variables = {
        **{name: str(folder / name.lower()) for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME")},
        "PATH": os.environ.get("PATH", ""),
        "HOME": str(folder),
        "XDG_RUNTIME_DIR": str(folder / "runtime"),
        "ROS_HOME": str(folder / "ros"),
        "ROS_PACKAGE_PATH": f"{folder / 'src'}:{LIBRARY}",
        "ROS_MASTER_URI": "http://localhost:1",
        "NO_COLOR": "1",
        "COLUMNS": "100",
        "LANG": "C.UTF-8",
    }
    with ExitStack() as replaced:
        replaced.enter_context(patch.dict(os.environ, variables, clear=True))
        for name in ("execv", "execve", "execvp", "execvpe"):
            replaced.enter_context(patch.object(os, name, _refuse_exec))
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def _refuse_exec(*words: object) -> None:
    raise AssertionError(f"this input is not wrong: another program would take the place of this process: {words}")


def describe(words: list[str], folder: str) -> str:
    """One command line, its exit code and what it prints."""
    printed = io.StringIO()
    with redirect_stdout(printed), redirect_stderr(printed), patch.object(sys, "stdin", io.StringIO()):
        code = main(words)
    text = re.sub(rf"{re.escape(tempfile.gettempdir())}/tmp\w+", "TMP", printed.getvalue().replace(folder, "~"))
    text = text.replace(str(LIBRARY.parent), "UR")
    lines = "".join(f"    {line}".rstrip() + "\n" for line in text.splitlines())
    return f"$ ur {shlex.join(words)}\n  -> {code}\n{lines}\n"
