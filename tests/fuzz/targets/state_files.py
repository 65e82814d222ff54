"""Files that programs of this project have written, and that others may have changed: runs, memories, robot.yaml."""

import os
from contextlib import suppress
from pathlib import Path

import yaml
from tests.fuzz.target import Target

from ur.request.remote import boot_command
from ur.robot.boot.launch_file import RobotLaunch
from ur.robot.boot.units import set_base_script
from ur.robot.commit_confirm.rename import name_robot_file
from ur.robot.discovery.record import load_records
from ur.robot.discovery.seen import load_seen
from ur.robot.robot_file import load_robot_file
from ur.robot.selection import load_selection
from ur.robot.setup.robot_states import WantedRobot, robot_file
from ur.robot.sync.steps import load_memory
from ur.run.clients.protocol import BadLineError, parse_command, parse_event
from ur.run.record.registry import Computer, list_runs
from ur.run.remote.own_clients import read_clients
from ur.source.diagnostic import UserError
from ur.source.render import render_human

_JSON_WORDS = (
    *(b'"run"', b'"pid"', b'"born"', b'"title"', b'"machine"', b'"boot"', b'"started"', b'"nodes"', b'"clients"'),
    *(b"NaN", b"Infinity", b"1e400", b"-0", b'"\\ud800"', b'"\\u0000"', b"[[]]", b'{"a": {}}', b"null,", b"]", b"}"),
)
_YAML_WORDS = (
    *(b"name: ", b"base: ", b"variant: ", b"devices: ", b"&a", b"*a", b"<<: *a", b"!!binary ", b"!!python/none", b"? "),
    *(
        b"- ",
        b"|\n",
        b">\n",
        b"---\n",
        b"...\n",
        b"%YAML 1.2\n",
        b"2001-01-01",
        b"0o7",
        b"1:30",
        b"=",
        b"!!int x",
        b"#",
    ),
)


def _list_runs(data: bytes, folder: Path) -> None:
    run = folder / "ur" / "runs" / "a.1"
    run.mkdir(parents=True)
    for each in (folder, folder / "ur", folder / "ur" / "runs", run):
        each.chmod(0o700)
    (run / "run.json").write_bytes(data)
    (run / "clients.json").write_bytes(data)
    list_runs({"XDG_STATE_HOME": str(folder), "XDG_RUNTIME_DIR": str(folder)}, os.getuid(), Computer("m", "b", "h"))
    if run.is_dir():
        read_clients(str(run))


def _read_events(data: bytes, _: Path) -> None:
    for line in data.split(b"\n"):
        for parse in (parse_event, parse_command):
            with suppress(BadLineError):
                repr(parse(line))


def _remember(data: bytes, folder: Path) -> None:
    file = folder / "records" / "a.yaml"
    file.parent.mkdir()
    file.write_bytes(data)
    load_records(file.parent)
    load_seen(file)
    load_memory(file)
    with suppress(UserError):
        load_selection(file)


def _read_robot_file(data: bytes, folder: Path) -> None:
    file = folder / "robot.yaml"
    file.write_bytes(data)
    try:
        load_robot_file(file)
    except UserError as problem:
        render_human(problem.diagnostics)
    text = data.decode(errors="surrogateescape")
    boot_command._facts(RobotLaunch("/a.launch", b"", text))
    name_robot_file(text, "ann")
    made = robot_file(WantedRobot("ann", "magni", "lidar"), text)
    assert made.endswith("\n") or text, "a file without an end"
    script = set_base_script(file).partition("master =")[0]  # what follows speaks to a master
    with suppress(SystemExit):
        exec(script, {"__name__": "fuzz"})


def _has_yaml() -> list[bytes]:
    return [
        yaml.safe_dump({"name": "bob", "base": "magni", "variant": "lidar", "devices": {"base": "/dev/a"}}).encode()
    ]


TARGETS = (
    Target("run_json", _list_runs, _JSON_WORDS),
    Target("run_events", _read_events, _JSON_WORDS),
    Target("remembered", _remember, (*_JSON_WORDS, *_YAML_WORDS)),
    Target("robot_yaml", _read_robot_file, _YAML_WORDS, _has_yaml),
)
