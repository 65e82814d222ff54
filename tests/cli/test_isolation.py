"""Nothing of the current folder is imported: every entry point starts in a folder of hostile modules."""

import importlib.metadata
import os
import pty
import re
import shlex
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest
from tests.ros_session import RosSession

from ur.cli.verbs import VERBS
from ur.robot import remote_run
from ur.robot.boot.launch_file import find_launch
from ur.robot.boot.units import launch_line, master_unit
from ur.robot.doctor.messages import MESSAGES_SCRIPT
from ur.robot.setup.environment import viewer_environment
from ur.robot.setup.wanted import WantedFile
from ur.robot.ssh.shell import LocalShell
from ur.run.debugger.environment import find_debug_tools
from ur.source import UserError

ROOT = Path(__file__).parents[2]
PYTHON = str(ROOT / ".venv/bin/python")
UR = str(ROOT / "ur")
NODE = str(ROOT / "ubiquity_launches/lib/node")
# Without `open`: a module like encodings is imported before there is one.
HOSTILE = """\
import posix
posix.write(posix.open({marks!r}, posix.O_WRONLY | posix.O_APPEND | posix.O_CREAT, 0o600), {name!r} + b"\\n")
raise SystemExit
"""
LAUNCH = '<launch>\n  <arg name="a" default="$(eval 1 + 1)"/>\n  <node pkg="p" type="t" name="n"/>\n</launch>\n'

# Each is the cheapest use of a verb that does more than print help; all verbs are also asked for their help.
CALLS = [
    "--version",
    "--help",
    "list",
    "launch --nodes a.launch",
    "launch --dump-params a.launch",
    "launch no.launch",
    "run",
    "ps --json",
    "attach",
    "logs n",
    "stop --all",
    "check a.launch",
    "package .",
    "format --check a.launch",
    "find n",
    "docs a.launch --output -",
    "graph a.launch",
    "explain a.launch n",
    "use",
    "robots --json --seconds 0",
    "shell nobody true",
    "completion zsh",
    "env",
    "__complete bash 'ur launch a'",
    "__complete bash 'ur launch --'",
    "__complete bash 'ur check '",
]

ALL_HELP = """\
import sys
from ur.cli.main import main
for verb in sys.argv[1:]:
    assert main([verb, "--help"]) == 0, verb
"""


class Trap:
    """A folder with a module of every name that our programs may import; each one notes that it was imported."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "downloaded"
        self.folder.mkdir()
        self._marks = folder / "imported"
        for name in _importable_names():
            (self.folder / f"{name}.py").write_text(HOSTILE.format(marks=bytes(self._marks), name=name.encode()))
        (self.folder / "a.launch").write_text(LAUNCH)
        (folder / "home").mkdir()
        (folder / "home/ubiquity_launches").symlink_to(ROOT)
        # An empty entry of PYTHONPATH is the current folder: what `PYTHONPATH=$PYTHONPATH:/x` makes of an unset one.
        self.environment = {
            "PATH": "/usr/bin:/bin",
            "HOME": str(folder / "home"),
            "XDG_RUNTIME_DIR": str(folder),
            "TERM": "xterm",
            "ROS_MASTER_URI": "http://localhost:1",
            "PYTHONPATH": ":",
        }

    def run(
        self, *command: str, stdin: str = "", more: Mapping[str, str] | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Run a program in the folder; fails when a module was imported from there."""
        done = subprocess.run(
            command,
            cwd=self.folder,
            env={**self.environment, **(more or {})},
            input=stdin,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert self.imported() == [], done
        assert "Traceback" not in done.stderr
        return done

    def imported(self) -> list[str]:
        """List the modules that were imported from the folder."""
        return self._marks.read_text().splitlines() if self._marks.exists() else []


def _importable_names() -> set[str]:
    installed = {name for name in importlib.metadata.packages_distributions() if name.isidentifier()}
    ros = {path.stem for path in Path("/usr/lib/python3/dist-packages").iterdir() if path.stem.isidentifier()}
    return installed | ros | set(sys.stdlib_module_names) | {"ur", "ur_nodes", "sitecustomize", "usercustomize"}


@pytest.fixture
def trap(tmp_path: Path) -> Trap:
    return Trap(tmp_path)


def test_trap_catches_a_program_that_imports_from_the_current_folder(trap: Trap) -> None:
    with pytest.raises(AssertionError):
        trap.run(PYTHON, "-m", "ur", "--version")


def test_verbs_import_nothing_of_the_current_folder(trap: Trap) -> None:
    assert trap.run(UR, "check", "a.launch").returncode in (0, 1)
    for call in CALLS:
        trap.run(UR, *shlex.split(call))
    # The help of all in one process, which imports what each would import in its own.
    done = trap.run(PYTHON, "-I", "-c", ALL_HELP, *VERBS)
    assert done.returncode == 0, done


def test_shells_import_nothing_of_the_current_folder(trap: Trap) -> None:
    (text,) = (each.text for each in viewer_environment(ROOT) if isinstance(each, WantedFile))
    assert text
    done = trap.run("/bin/bash", "-c", f'{text}\necho "$UR_SELECTION"')
    assert done.stdout.startswith("sim")


def test_boot_units_import_nothing_of_the_current_folder(trap: Trap) -> None:
    done = trap.run("/bin/bash", "-c", launch_line("no_such_package", "no.launch", []))
    assert "no_such_package" in done.stderr
    (line,) = re.findall("^ExecStartPost=-(.*)$", master_unit("ros", "/home/ros").text, re.M)
    words = shlex.split(line.replace("$$", "$").replace("%%", "%").replace("\\n", "\n"))
    trap.run(*words)


def test_remote_runs_import_nothing_of_the_current_folder(trap: Trap) -> None:
    request = '{"action": "end", "machine": "bob", "words": ["no.launch"]}'
    done = trap.run("/bin/bash", "-lc", remote_run._SCRIPT, stdin=request)
    assert done.stdout.strip().startswith("{")
    request = request.replace("end", "begin")
    done = trap.run("/bin/bash", "-lc", remote_run._SCRIPT, stdin=request)
    assert "no.launch" in done.stdout  # it was started, and said what it misses


def test_scripts_for_other_computers_import_nothing_of_the_current_folder(
    trap: Trap, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "std_msgs/String" in trap.run("/bin/sh", "-c", MESSAGES_SCRIPT).stdout
    monkeypatch.chdir(trap.folder)
    with pytest.raises(UserError):
        find_launch(LocalShell(), "no_such_package", "no.launch", "bob")
    find_debug_tools({}, terminal=False, python="/usr/bin/python3")
    assert trap.imported() == []


def test_helper_processes_import_nothing_of_the_current_folder(trap: Trap) -> None:
    pip = "from ur.request.requirements.python_packages import need_all; from pathlib import Path; import sys"
    lock = trap.folder.parent / "requirements/none.lock"
    lock.parent.mkdir()
    lock.touch()
    trap.run(
        PYTHON,
        "-I",
        "-c",
        f"{pip}; need_all(['no_such'], 'none.lock', 'nothing', folder=Path(sys.argv[1]))",
        str(lock.parents[1]),
    )
    camera = (
        "from ur_nodes.simulator.camera.camera_process import _start; p = _start('egl', dict()); p.communicate(b'{')"
    )
    trap.run(PYTHON, "-I", "-c", camera)


def test_interface_imports_nothing_of_the_current_folder(trap: Trap) -> None:
    controller, end = pty.openpty()
    try:
        code = (
            "import sys; from ur.tui.start import InterfaceProcess\n"
            "with InterfaceProcess(sys.argv[1]): pass\n"  # a run that never begins
        )
        done = subprocess.run(
            [PYTHON, "-I", "-c", code, "full"],
            cwd=trap.folder,
            env=trap.environment,
            stdin=end,
            stdout=end,
            stderr=subprocess.PIPE,
            timeout=60,
            text=True,
            check=False,
            start_new_session=True,
        )
    finally:
        os.close(controller)
        os.close(end)
    assert (done.returncode, trap.imported()) == (0, []), done.stderr


@pytest.mark.ros
def test_nodes_import_nothing_of_the_current_folder(trap: Trap, tmp_path: Path) -> None:
    session = RosSession(tmp_path / "ros")
    network = {name: session.env[name] for name in ("ROS_MASTER_URI", "ROS_HOSTNAME")}
    try:
        words = ("ur_nodes.mapping.map_server_node", str(trap.folder / "no.yaml"))
        done = trap.run(NODE, *words, more=network)
        assert "no.yaml" in done.stderr
        debugged = trap.run(NODE, *words, more={**network, "UR_NODE_PYTHON_OPTIONS": "-X dev"})
        assert "no.yaml" in debugged.stderr
        launch = trap.folder / "map.launch"
        launch.write_text(
            '<launch><node pkg="ubiquity_launches" type="map_server" name="map" args="no.yaml"'
            ' required="true"/></launch>'
        )
        # roslaunch and rosmaster are not ours: they do as PYTHONPATH says. Nodes start in ROS_HOME.
        world = {**network, "PYTHONPATH": "", "ROS_PACKAGE_PATH": str(ROOT), "ROS_HOME": str(trap.folder)}
        done = trap.run("/usr/bin/roslaunch", str(launch), more=world)
        assert "no.yaml" in done.stdout + done.stderr
        done = trap.run(UR, "launch", "--plain", str(launch), more=world)
        assert "no.yaml" in done.stdout + done.stderr
    finally:
        session.close()


def test_every_python_that_we_start_is_isolated() -> None:
    spawned = re.compile(r'\[(.*, )?sys\.executable, (?!"-I")|/bin/python"? -(?!I)|python3 -(?!I)')
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in [*(ROOT / "src").rglob("*.py"), ROOT / "ur", Path(NODE)]
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if spawned.search(line)
    ]
    assert found == []
