"""The memory of a robot with its own drivers: `./test tests/e2e/test_memory.py -m nightly -s` prints it by process.

The simulator stands for the devices of a Create 2 on pseudo-terminals, in a run of its own, which is not counted. Files
that its processes map, too, count in full, as on a computer that runs the robot alone.
"""

import os
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from tests.e2e.conftest import ROOT, LaunchedRobot, end, list_family, make_environment
from tests.e2e.web_page import start_server
from tests.json_client import wait_until

pytestmark = [pytest.mark.ros, pytest.mark.nightly, pytest.mark.timeout(600)]

LIBRARY = "$(find ubiquity_launches)"
MAP = f"{LIBRARY}/n_map_server/maps/maze.yaml"
NODE = re.compile(r"__name:=(\w+)|ur_nodes\.(web\.robot_endpoint)_node|(rosmaster|ur\0launch|ur\0web|ur-[\w-]+)")
FORKING = "ur_nodes.fork_server"


def include(name: str, **arguments: str) -> str:
    given = "".join(f'<arg name="{key}" value="{value}"/>' for key, value in arguments.items())
    return f'<include file="{LIBRARY}/{name}/launch/{name}.launch.xml">{given}</include>'


@contextmanager
def launch(folder: Path, env: dict[str, str], name: str, *includes: str) -> Iterator[subprocess.Popen[str]]:
    """Run `ur launch` with these files until the context ends."""
    file = folder / f"{name}.launch"
    file.write_text(f'<launch><machine name="localhost" address="localhost"/>{"".join(includes)}</launch>')
    with (folder / f"{name}.log").open("w") as log:
        command = [str(ROOT / "ur"), "launch", str(file)]
        process = subprocess.Popen(command, env=env, stdin=subprocess.DEVNULL, stdout=log, stderr=log, text=True)
        try:
            yield process
        finally:
            end(process)


def read(pid: int, file: str) -> str:
    try:
        return Path("/proc", str(pid), file).read_text(errors="replace")
    except OSError:  # it has ended
        return ""


def measure(pids: Iterable[int]) -> tuple[Counter[str], float]:
    """The MB of each process by name, without files, and those of the files that all of them map."""
    own, files = Counter[str](), Counter[str]()
    for pid in pids:
        match = NODE.search(read(pid, "cmdline"))
        name = next(filter(None, match.groups())) if match else read(pid, "comm").strip()
        if share := re.search(r"Pss_Anon: +(\d+)", read(pid, "smaps_rollup")):
            own[name] += int(share[1]) * 1024
        for found in re.finditer(r"^\S+ \S+ (\S+ \S+ \d+)( .*\n)((?:\w+: .*\n)+)", read(pid, "smaps"), re.M):
            sizes = dict(re.findall(r"(\w+): +(\d+) kB", found[3]))
            mapping = found[1] + found[2]
            files[mapping] = max(files[mapping], (int(sizes["Rss"]) - int(sizes["Anonymous"])) * 1024)
    return Counter({name: size / 1e6 for name, size in own.items()}), sum(files.values()) / 1e6


@pytest.mark.parametrize(
    ("variant", "navigation", "page", "limit"),
    [("lidar", True, False, 295), ("lidar", True, True, 350), ("", False, True, 175)],
    ids=["navigation", "navigation-and-page", "base-and-page"],
)
def test_robot_fits_into_the_memory_of_its_board(
    tmp_path: Path, variant: str, navigation: bool, page: bool, limit: float
) -> None:
    env, base, devices = make_environment(tmp_path), {"robot_base": "create2"}, str(tmp_path / "devices")
    more = {"simulate": "false", "device_folder": devices, "black_box": str(navigation).lower()}
    robot = [include("m_robot_base", **base, robot_variant=variant, **more)]
    robot += [include("m_move_base", **base, map_file=MAP)] if navigation else []
    with ExitStack() as stack:
        pids = [stack.enter_context(launch(tmp_path, env, "robot", *robot)).pid]
        wait_until(
            lambda: "[/cmd_vel_mux] started" in (tmp_path / "robot.log").read_text(), 120.0, "the mux starts", 0.5
        )
        simulator = include("n_simulator", **base, robot_variant=variant, world="maze", devices=devices)
        stand_in = stack.enter_context(launch(tmp_path, env, "simulator", simulator))
        if page:
            stack.enter_context(start_server(env, tmp_path))
            pids += [pid for pid in list_family(os.getpid()) if "ur\0web" in read(pid, "cmdline")]
        if navigation:
            client = LaunchedRobot(stand_in, env, tmp_path / "simulator.log")
            stack.callback(client.client.wait)
            stack.callback(client.client.kill)
            client.ask("ready", seconds=150)
            assert client.ask("goal", x=0.7, y=0.0, seconds=90)["state"] == "SUCCEEDED"
        wait_until(
            lambda: not any(FORKING in read(each, "cmdline") for each in list_family(pids[0])),
            *(120.0, "the process that forks nodes ends", 0.5),
        )
        own, files = measure(each for pid in pids for each in list_family(pid))
    table = [f"{megabytes:6.1f} MB  {name}" for name, megabytes in [*own.most_common(), ("files", files)]]
    total = sum(own.values()) + files
    sys.stdout.write("\n".join(["", *table, f"{total:6.1f} MB in all\n"]))
    assert total < limit
