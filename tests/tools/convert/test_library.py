"""The launch library for `ros2 launch`: each file starts the same nodes as `ur launch`, for every base and option."""

import json
import os
import shlex
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest
from tests.tools.convert.ros2_launch import LaunchedNode2, Ros2LaunchReader

from ur.check.cases import list_cases, list_unknown
from ur.check.collect import collect_targets
from ur.check.rule import survey_launch_file
from ur.check.worlds import CachedWorld, make_world
from ur.cli.main import main
from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.run.middleware.parameter_files import format_parameters
from ur.source.diagnostic import Severity
from ur.tools.convert.package import ConvertedFiles, convert_all
from ur.tools.convert.write import write_prefix

LIBRARY = Path(__file__).parents[3] / "ubiquity_launches"
RENAMED = {("rviz", "rviz"): ("rviz2", "rviz2")}
# ROS 2 has no parameters of all nodes, and no on_exit= that an argument decides: docs/how-to/convert-launch-files.md.
NOT_COMPARED = {"use_sim_time", "robot_description"}
MORE: Mapping[str, tuple[dict[str, str], ...]] = {
    "m_keyboard_navigate": ({"localisation": "fiducials"}, {"navigation": "nav2"}, {"map": "lab"}),
    "m_make_map": ({"drive": "goals"}, {"drive": "joystick"}),
    "m_move_base": ({"localisation": "fiducials"},),
    "m_robot_base": ({"simulate": "devices"},),
    "n_joint_state_publisher": ({"source_list": "[wheels, arm]"},),
}
REQUIRED_BY_ARGUMENT = {"fiducial_slam"}


@cache
def converted() -> tuple[ConvertedFiles, CachedWorld]:
    world = CachedWorld(make_world([str(LIBRARY)], {"HOME": "/home/user", "PATH": os.environ["PATH"]}))
    return convert_all(str(LIBRARY), world, lambda _text: None), world


def test_every_library_file_starts_the_nodes_of_its_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/user")
    for name in ("XDG_DATA_HOME", "ROS_MASTER_URI", "ROS_DOMAIN_ID", "USER"):
        monkeypatch.delenv(name, raising=False)
    made, world = converted()
    texts = {each.path: each.text for each in (*made.launch_files, *made.parameter_files)}
    reader = Ros2LaunchReader(texts, {"ubiquity_launches": str(LIBRARY)})
    package = collect_targets([str(LIBRARY)], world).packages[str(LIBRARY)]
    compared = 0
    for file in made.launch_files:
        view = survey_launch_file(file.path, package, world)
        for case in list_cases(view):
            given = dict.fromkeys(list_unknown(view), "one") | dict(case.given)
            for more in ({}, *MORE.get(file.place.partition("/")[0], ())):
                arguments = given | more
                plan = load_plan([file.path], [f"{name}:={value}" for name, value in arguments.items()], world)
                assert not [found for found in plan.diagnostics if found.severity is Severity.ERROR]
                started = {each.name: describe(each) for each in reader.read(file.path, arguments)}
                assert started == planned(plan), f"{file.place} {arguments}"
                compared += 1
    assert compared > 500, compared


def test_converted_library_passes_the_check(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "share"))
    write_prefix(converted()[0], tmp_path)
    package = tmp_path / "share" / "ubiquity_launches"
    assert main(["check", str(package)]) == 0
    assert capsys.readouterr().out.startswith("nothing found in ")
    file = package / "n_amcl" / "launch" / "n_amcl.launch.xml"
    file.write_text(file.read_text().replace("$(var ", "$(var no_", 1))
    assert main(["check", str(package)]) == 1
    assert "undeclared-argument" in capsys.readouterr().out


def describe(node: LaunchedNode2) -> dict[str, object]:
    parameters = {name: value for name, value in flatten(node.parameters) if name not in NOT_COMPARED}
    options = {name: value for name, value in node.options.items() if value not in ("", "log")}
    return {
        "program": (node.package, node.program, node.args),
        "respawn": (options.pop("respawn", "false").lower(), float(options.pop("respawn_delay", "0"))),
        "required": options.pop("on_exit", "") == "shutdown",
        "prefix": options.pop("launch-prefix", ""),
        "output": options.pop("output", "log"),
        "others": options,
        "remaps": node.remaps,
        "environment": node.environment,
        "parameters": parameters,
    }


def planned(plan: Plan) -> dict[str, dict[str, object]]:
    files = format_parameters(plan, {})
    return {node.full_name: describe_plan(node, json.loads(files[node.full_name])) for node in plan.nodes}


def describe_plan(node: NodeSpec, file: Mapping[str, Mapping[str, Mapping[str, object]]]) -> dict[str, object]:
    parameters = file.get("/**", {}).get("ros__parameters", {})
    return {
        "program": (*RENAMED.get((node.package, node.type), (node.package, node.type)), shlex.split(node.args)),
        "respawn": (str(node.respawn).lower(), node.respawn_delay),
        "required": node.required and node.type not in REQUIRED_BY_ARGUMENT,
        "prefix": node.launch_prefix or "",
        "output": node.output,
        "others": {},
        "remaps": [(private(source), private(target)) for source, target in node.remaps],
        "environment": dict(node.env),
        "parameters": {name: value for name, value in flatten(parameters) if name not in NOT_COMPARED},
    }


def private(name: str) -> str:
    return f"~/{name[1:].lstrip('/')}" if name.startswith("~") else name


def flatten(values: Mapping[str, object], above: str = "") -> list[tuple[str, object]]:
    found: list[tuple[str, object]] = []
    for name, value in values.items():
        if isinstance(value, dict):
            found += flatten(value, f"{above}{name}.")
        else:
            found.append((above + name, list(value) if isinstance(value, tuple) else value))
    return found
