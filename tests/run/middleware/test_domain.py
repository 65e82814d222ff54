"""A domain of ROS 2 as the middleware of a run."""

import fcntl
import json
import os
from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.memory import MemoryWorld
from ur.request.bases.robot_facts import read_facts as read_robot_facts
from ur.request.joining.running import rename_taken
from ur.run.launch import find_middleware
from ur.run.master.parameters import start_commands
from ur.run.middleware.facts import read_facts
from ur.run.middleware.protocol import NoGraph
from ur.run.middleware.ros2 import DomainMiddleware, clear_shared_memory, find_ros2
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.run.supervisor.events import Exited, ParametersSet, SetupFailed, Unregistered
from ur.run.supervisor.state import ExitStatus
from ur.source.diagnostic import UserError

PLAN = Plan((), (), (), (), (), ())
LAUNCH = '<launch><node name="a" pkg="p" type="t"><param name="x" value="1"/></node></launch>'
WORLD = MemoryWorld({"/a.launch": LAUNCH})


def make_environment(folder: Path) -> dict[str, str]:
    (folder / "run").mkdir(mode=0o700)
    return {
        "HOME": str(folder),
        "PATH": os.environ["PATH"],
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DISTRO": "kilted",
        "ROS_DOMAIN_ID": "7",
        "ROS_VERSION": "2",
        "XDG_RUNTIME_DIR": str(folder / "run"),
    }


def make_domain(folder: Path) -> DomainMiddleware:
    return find_ros2(make_environment(folder), RunOptions())


def test_run_on_ros2_starts_no_master_and_names_its_domain(tmp_path: Path) -> None:
    domain = find_middleware(PLAN, make_environment(tmp_path), WORLD, RunOptions(), Console())
    assert (domain.address, domain.own, domain.run_id, domain.core) == ("ros2://localhost/7", True, "", ())
    assert domain.describe() == "ROS 2 Kilted, ROS_DOMAIN_ID=7, on this computer only"
    assert isinstance(domain.await_core(1.0), SetupFailed)


def test_port_of_a_master_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="--port 11312 chooses the port of a master, which ROS 2 does not have"):
        find_ros2(make_environment(tmp_path), RunOptions(port=11312))


def test_nodes_get_files_and_the_run_its_facts_until_its_end(tmp_path: Path) -> None:
    domain = make_domain(tmp_path)
    plan = load_plan(["/a.launch"], [], WORLD)
    folder = tmp_path / "the id"
    folder.mkdir()
    options = RunOptions(base="magni", variant="lidar")
    assert isinstance(domain.set_parameters(plan, str(folder), options, start_commands(plan.params, {})), ParametersSet)
    written = [json.loads(path.read_text()) for path in folder.iterdir()]
    assert written == [{"/**": {"ros__parameters": {"x": 1}}}]
    facts = domain.environment["UR_FACTS"]
    assert read_facts(facts) == {"run_id": "the id", "base_name": "magni", "variant": "lidar"}
    assert isinstance(domain.unregister(["/a"]), Unregistered)
    assert read_facts(facts) == {}


def test_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    domain = make_domain(tmp_path)
    plan = load_plan(["/a.launch"], [], WORLD)
    failed = domain.set_parameters(plan, str(tmp_path / "none"), RunOptions(), start_commands(plan.params, {}))
    assert isinstance(failed, SetupFailed)
    assert failed.reason == f"parameters cannot be written to {tmp_path}/none: no such file or directory"


def test_node_that_ends_was_not_ended_by_another_of_its_name(tmp_path: Path) -> None:
    domain = make_domain(tmp_path)
    event = Exited("/a", ExitStatus(0))
    assert domain.examine_exit(event) is event
    assert not domain.watch(lambda _event: None).is_set()


def test_graph_without_ros2_on_this_computer_is_named(tmp_path: Path) -> None:
    domain = find_ros2(make_environment(tmp_path) | {"AMENT_PREFIX_PATH": "/nowhere"}, RunOptions())
    view = domain.view()
    with pytest.raises(NoGraph, match="the node that reads the graph does not answer"):
        view.look(["/scan"])
    view.forget()


def test_domain_without_runs_has_no_robot(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name, value in make_environment(tmp_path).items():
        monkeypatch.setenv(name, value)
    assert read_robot_facts("ros2://localhost/7") is None
    plan = Plan((), (), (), (), (), ())
    assert rename_taken(plan, "", lambda _kind, _text: None) is plan


def test_shared_memory_of_killed_nodes_is_removed_and_that_of_others_stays(tmp_path: Path) -> None:
    killed = ["fastdds_00000000000000aa", "fastdds_00000000000000aa_el", "fastdds_port7411", "fastdds_port7411_sl"]
    kept = [
        "fastdds_00000000000000bb",
        "fastdds_00000000000000bb_el",
        "fastdds_port7413_el",
        "fastdds_mine",
        "other_el",
    ]
    for name in [*killed, "sem.fastdds_port7411_mutex", *kept]:
        (tmp_path / name).touch()
        os.utime(tmp_path / name, (0, 0))
    os.utime(tmp_path / "fastdds_port7413_el")  # a process that has not locked it yet
    with (tmp_path / "fastdds_00000000000000bb_el").open() as used:
        fcntl.flock(used, fcntl.LOCK_EX)
        clear_shared_memory(tmp_path)
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted(kept)
