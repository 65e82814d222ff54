"""The odd values once more as messages of both ROS: each node is a process, and a stranger sends them."""

import json
import subprocess
import sys
import xmlrpc.client
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.ros2_session import PYTHON, Ros2Session
from tests.ros_session import RosSession
from tests.ur_nodes.odd_values.started import ARGUMENTS, MODULES, PARAMETERS, SOCKETS, StartedNode, name_of

STRANGER = str(Path(__file__).with_name("stranger.py"))
TERMINALS = ("keyboard_navigate", "teleop_twist_keyboard", "image_terminal", "explore_progress", "calibrate_camera")
PROGRAMS = [each for each in MODULES if name_of(each) not in (*SOCKETS, *TERMINALS)]
WITHIN = 100.0  # s


class Ros1Trial:
    """A node and a stranger on a master."""

    def __init__(self, folder: Path) -> None:
        self.session = RosSession(folder)
        self.environment = self.session.env

    def start(self, module: str, words: list[str], parameters: dict[str, Any]) -> subprocess.Popen[str]:
        with xmlrpc.client.ServerProxy(self.environment["ROS_MASTER_URI"]) as master:
            for name, value in parameters.items():
                master.setParam("/test", f"/odd/{name}", value)
        return self.session.start(sys.executable, "-m", "ur_nodes", module, *words, "__name:=odd")

    def attack(self, trial: str) -> str:
        return subprocess.run(
            [sys.executable, STRANGER, trial],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=WITHIN,
            check=True,
        ).stdout


class Ros2Trial:
    """A node and a stranger in a domain."""

    def __init__(self, folder: Path) -> None:
        self.session, self._folder = Ros2Session(folder), folder

    def start(self, module: str, words: list[str], parameters: dict[str, Any]) -> subprocess.Popen[str]:
        file = self._folder / "parameters.yaml"
        file.write_text(yaml.safe_dump({"/**": {"ros__parameters": parameters or {"unused": 0}}}))
        return self.session.start("odd", module, *words, "--ros-args", "--params-file", str(file))

    def attack(self, trial: str) -> str:
        done = self.session.run(STRANGER, trial, within=WITHIN)
        assert done.returncode == 0, done.stderr
        return done.stdout


def described(module: str, patch: pytest.MonkeyPatch) -> dict[str, list[tuple[str, str]]]:
    """The topics, services and outputs of a node, with the full names of their kinds."""
    started = StartedNode(module, patch)
    started.bus.run(1.0)
    found = {"topics": started.topics(), "services": started.services(), "outputs": started.outputs()}
    started.close()
    return {
        part: [(name, f"{kind.__module__}.{kind.__name__}") for name, kind in each.items() if kind is not dict]
        for part, each in found.items()
    }


def by_name(value: object) -> object:
    """Parameters as ROS 2 has them: lists of mappings as mappings by name, lists of lists as text."""
    if isinstance(value, list) and value and isinstance(value[0], list):
        return json.dumps(value)
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return {each["name"]: {key: one for key, one in each.items() if key != "name"} for each in value}
    if isinstance(value, dict):
        return {key: by_name(each) for key, each in value.items() if each != []}
    return value


@pytest.mark.ros
@pytest.mark.nightly
@pytest.mark.timeout(200)
@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("module", PROGRAMS)
def test_process_of_a_node_answers_odd_messages_without_an_end_or_a_motion(
    module: str, version: int, home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if version == 2 and not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    with monkeypatch.context() as patch:
        trial = described(module, patch)
    stage: Ros1Trial | Ros2Trial = Ros1Trial(home) if version == 1 else Ros2Trial(home)
    name = name_of(module)
    parameters: Any = by_name(PARAMETERS.get(name, {}))
    try:
        node = stage.start(module, ARGUMENTS.get(name, []), parameters)
        report = json.loads(stage.attack(json.dumps(trial)).splitlines()[-1])
        assert node.poll() is None, node.communicate()[1] if version == 1 else (home / "odd.txt").read_text()
    finally:
        stage.session.close()
    assert report["moved"] == []
    assert report["sent"] > 0 or not trial["topics"]
