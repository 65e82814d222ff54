"""Boot units: systemd reads them, and the words of a command arrive as they were given."""

import re
import shutil
import subprocess
import threading
from pathlib import Path
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from ur.robot.boot.units import (
    command_line,
    guard_units,
    is_unit_name,
    launch_line,
    master_unit,
    page_line,
    program_unit,
    set_base_script,
)

MASTER_UNIT = "ubiquity-master"
WORDS = ("rostopic", "pub", "/x", "std_msgs/String", "data: 'it''s 100%'", "$HOME", 'a "b" \\c')


def test_program_is_started_after_the_master_and_restarted_with_it() -> None:
    text = program_unit("drive", "exec roslaunch p f", "ros", "/home/ros").text
    assert "After=network-online.target avahi-daemon.service ubiquity-master.service" in text
    assert "PartOf=ubiquity-master.service" in text
    assert "Restart=always" in text


def test_program_of_a_robot_with_ros2_waits_for_no_master() -> None:
    text = program_unit("drive", "exec true", "ros", "/home/ros", master=False).text
    assert "After=network-online.target avahi-daemon.service\n" in text
    assert MASTER_UNIT not in text


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
def test_guards_of_motors_are_units_that_systemd_reads_and_that_the_oom_killer_spares(tmp_path: Path) -> None:
    texts = guard_units("root", "/root")
    for path, text in texts.items():
        (tmp_path / Path(path).name).write_text(text)
    for name in (Path(path).name for path in texts):
        done = subprocess.run(
            ["systemd-analyze", "verify", str(tmp_path / name)], capture_output=True, text=True, check=False
        )
        assert "motor-guard" not in done.stderr
    socket, service = texts.values()  # a change of the service restarts the socket, which is there then
    assert "\nOOMScoreAdjust=-1000\n" in service
    assert "\nSocketMode=0600\n" in socket
    assert measure_exposure(tmp_path / "motor-guard@.service") < 3.0


def measure_exposure(unit: Path) -> float:
    """What `systemd-analyze security` says of a unit, from 0 to 10."""
    done = subprocess.run(
        ["systemd-analyze", "security", "--offline=true", str(unit)], capture_output=True, text=True, check=False
    )
    found = re.search(r"Overall exposure level for \S+: ([0-9.]+)", done.stdout)
    assert found, done.stderr
    return float(found[1])


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
@pytest.mark.parametrize("user", ["ros", "root"])
def test_unit_has_the_rights_that_programs_of_a_robot_need_and_few_others(tmp_path: Path, user: str) -> None:
    for unit in (master_unit(user, "/data/my home"), program_unit("drive", "exec roslaunch p f", user, "/home/ros")):
        path = tmp_path / f"{unit.service}.service"
        path.write_text(unit.text)
        assert measure_exposure(path) < 5.0
        verified = subprocess.run(["systemd-analyze", "verify", str(path)], capture_output=True, text=True, check=False)
        assert path.name not in verified.stderr
    assert 'ReadWritePaths="-/data/my home" ' in master_unit(user, "/data/my home").text
    # Serial ports, cameras, GPIO, and files that programs share.
    for taken in (
        "PrivateDevices",
        "ProtectClock",
        "DeviceAllow",
        "ProtectKernelTunables",
        "PrivateTmp",
        "ProtectHome",
    ):
        assert taken not in unit.text


def run_script(path: Path) -> subprocess.CompletedProcess[str]:
    script = set_base_script(path)
    return subprocess.run(["/usr/bin/python3", "-c", script], capture_output=True, text=True, check=False, timeout=90)


def test_master_is_told_the_base_before_programs_start() -> None:
    text = master_unit("ros", "/home/ros").text
    assert text.index("ExecStart=") < text.index("ExecStartPost=-") < text.index("[Install]")
    assert "/ur/base_name" in text
    assert "roscore -w 32" in text  # with few threads, a lost viewer keeps the robot's nodes from each other
    assert "ExecStartPost" not in program_unit("drive", "exec roslaunch p f", "ros", "/home/ros").text


def test_computer_without_a_robot_file_tells_nothing(tmp_path: Path) -> None:
    done = run_script(tmp_path / "none.yaml")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("text", ["name: bob\n", "[1, 2\n", "3\n"])
def test_robot_file_that_cannot_be_used_is_named_in_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    done = run_script(path)
    assert done.returncode == 1
    assert done.stderr.startswith(f"{path}: ")
    assert "Traceback" not in done.stderr


class Master:
    """Parameters of a ROS master, by XML-RPC."""

    def __init__(self, **facts: str) -> None:
        self.facts = facts

    def getParam(self, _: str, name: str) -> tuple[int, str, str | int]:  # noqa: N802 - ROS's name
        return (1, "", self.facts[name]) if name in self.facts else (-1, "not set", 0)

    def setParam(self, _: str, name: str, value: str) -> tuple[int, str, int]:  # noqa: N802 - ROS's name
        self.facts[name] = value
        return 1, "", 0


@pytest.mark.parametrize(
    ("facts", "changed"),
    [
        ({}, "changed /ur/base_name\nchanged /ur/variant\n"),
        ({"/ur/base_name": "magni", "/ur/variant": ""}, "changed /ur/variant\n"),
        ({"/ur/base_name": "magni", "/ur/variant": "lidar"}, ""),
    ],
)
def test_running_master_gets_what_changed_in_the_robot_file(
    tmp_path: Path, facts: dict[str, str], changed: str
) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("name: bob\nbase: magni\nvariant: lidar\n", encoding="utf-8")
    master = Master(**facts)
    with SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False, allow_none=True) as server:
        server.register_instance(master)
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        environment = {"PATH": "/usr/bin:/bin", "ROS_MASTER_URI": f"http://127.0.0.1:{server.server_address[1]}"}
        words = ["/usr/bin/python3", "-c", set_base_script(path, seconds=0.0)]
        done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True, timeout=90)
        server.shutdown()
        thread.join()
    assert done.stdout == changed
    assert master.facts == {"/ur/base_name": "magni", "/ur/variant": "lidar"}
    again = subprocess.run(words, env=environment, capture_output=True, text=True, check=False, timeout=90)
    assert (again.returncode, again.stdout) == (1, "")
    assert "Traceback" not in again.stderr


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
def test_units_are_what_systemd_expects(tmp_path: Path) -> None:
    units = [master_unit("root", "/root"), program_unit("drive", command_line(WORDS), "root", "/root")]
    units.append(program_unit("talk", launch_line("p", "f.launch", ["a:=it's 100% $HOME"]), "root", "/root"))
    for unit in units:
        (tmp_path / f"{unit.service}.service").write_text(unit.text)
    paths = [str(tmp_path / f"{unit.service}.service") for unit in units]
    done = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", *paths], capture_output=True, text=True, check=False
    )
    complaints = [line for line in done.stderr.splitlines() if "ubiquity-" in line]
    assert complaints == []


@pytest.mark.parametrize(
    ("name", "good"), [("drive", True), ("m_nav-2", True), ("master", False), ("a b", False), ("../x", False)]
)
def test_unit_names_are_plain_words(name: str, good: bool) -> None:
    assert is_unit_name(name) is good


def back_off(folder: Path, *, restarts: int, uptime: int) -> tuple[str, int]:
    """What the unit's own script says, and how long it pauses, started `restarts` times by itself at this uptime."""
    unit = folder / "x.service"
    unit.write_text(program_unit("x", "exec true", "ros", "/home/ros").text)
    line = unit.read_text().split("ExecStartPre=/bin/sh -c ")[2].split("\n")[0]
    script = line[1:-1].replace("$$", "$").replace("\\n", "\n").replace('\\"', '"')
    tools = {
        "systemctl": f"echo {restarts}",
        "cut": f"echo {uptime}",
        "sleep": 'echo "$1" >slept',
    }
    for name, text in tools.items():
        (folder / name).write_text(f"#!/bin/sh\n{text}\n")
        (folder / name).chmod(0o755)
    environment = {"PATH": f"{folder}:/usr/bin:/bin", "RUNTIME_DIRECTORY": str(folder)}
    done = subprocess.run(["/bin/sh", "-c", script], env=environment, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout, int((folder / "slept").read_text())


def test_pauses_grow_while_it_keeps_ending_and_begin_anew_after_a_calm_time(tmp_path: Path) -> None:
    uptime = 1000
    pauses = []
    for restarts in range(8):
        said, pause = back_off(tmp_path, restarts=restarts, uptime=uptime)
        assert bool(said) == bool(pause)
        pauses.append(pause)
        uptime += 5
    assert pauses == [0, 2, 4, 8, 16, 32, 60, 60]
    assert back_off(tmp_path, restarts=8, uptime=uptime + 60) == ("", 0)
    assert back_off(tmp_path, restarts=9, uptime=uptime + 62)[1] == 2
    assert back_off(tmp_path, restarts=0, uptime=uptime + 63) == ("", 0)  # started by hand


@pytest.mark.parametrize("ready", [True, False])
def test_launch_file_is_started_by_ur_where_it_is_set_up_else_by_roslaunch(tmp_path: Path, ready: bool) -> None:
    home = tmp_path / "home"
    for path, text in (
        (home / "ubiquity_launches/.venv/bin/python", 'echo "ur: $*"'),
        (tmp_path / "bin/roslaunch", 'echo "roslaunch: $*"'),
    ):
        path.parent.mkdir(parents=True)
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)
    if ready:
        (home / "ubiquity_launches/.venv/ready-run").touch()
    environment = {"HOME": str(home), "PATH": f"{tmp_path / 'bin'}:/usr/bin:/bin"}
    line = launch_line("p", "f.launch", ["words:=it's $HOME"])
    done = subprocess.run(["/bin/bash", "-c", line], env=environment, capture_output=True, text=True, check=True)
    starter = "ur: -I -m ur launch --plain" if ready else "roslaunch:"
    assert done.stdout == f"{starter} --wait p f.launch words:=it's $HOME\n"


def test_launch_file_of_a_robot_with_ros2_is_never_started_by_roslaunch(tmp_path: Path) -> None:
    done = run_line(launch_line("p", "f.launch", [], roslaunch=False), tmp_path)
    assert (done.returncode, "ur robot setup" in done.stderr) == (1, True)


def test_page_is_served_by_the_copy_that_is_set_up_and_says_so_where_there_is_none(tmp_path: Path) -> None:
    python = tmp_path / "ubiquity_launches/.venv/bin/python"
    done = run_line(page_line("--service"), tmp_path)
    assert (done.returncode, "ur robot setup" in done.stderr) == (1, True)
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\nprintf "%s|" "$@"\n')
    python.chmod(0o755)
    (tmp_path / "ubiquity_launches/.venv/ready-run").touch()
    assert run_line(page_line("--service"), tmp_path).stdout == "-I|-m|ur|web|--service|"


def run_line(line: str, home: Path) -> subprocess.CompletedProcess[str]:
    """Run a line as the unit does, for a user with this home."""
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(home)}
    return subprocess.run(["bash", "-c", line], env=environment, capture_output=True, text=True, check=False)
