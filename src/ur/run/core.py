"""The master of a run: the one that is there, or our own together with rosout."""

from __future__ import annotations

import shutil
import time
from collections.abc import Mapping

from ur.launchfile.plan.model import ParamValue
from ur.launchfile.world import World
from ur.run.command import Program
from ur.run.console import Console
from ur.run.happenings import Event, MasterAnswered, SetupFailed
from ur.run.master import DEFAULT_PORT, Master, parse_master_uri
from ur.run.model import Unit
from ur.run.options import Options
from ur.run.places import is_local_address
from ur.run.xml_rpc import Refused, Unanswered
from ur.source.diagnostic import UserError, error

MASTER = "master"
ROSOUT = "/rosout"
WORKERS = 3  # rosmaster.master_api.NUM_WORKERS


def find_master(environment: Mapping[str, str], options: Options) -> Master:
    """Where the master of a run is, or will be. Raises UserError for a ROS_MASTER_URI that is none."""
    master = parse_master_uri(environment.get("ROS_MASTER_URI") or f"http://localhost:{DEFAULT_PORT}")
    if options.port is None:
        return master
    return parse_master_uri(f"http://{master.host}:{options.port}")


def read_run_id(master: Master, options: Options, console: Console) -> str | None:
    """The run id of the master that is there, '' when it has none; None when we may start one.

    Raises UserError for a master on another computer that does not answer.
    """
    told = False
    while True:
        try:
            return master.get_run_id() or ""
        except Unanswered as problem:  # noqa: PERF203 - asking again is the point
            if not options.wait_for_master:
                if is_local_address(master.host):
                    return None
                raise UserError(
                    error(
                        f"no ROS master answers at {master.uri}: {problem}",
                        rule="no-master",
                        help="is the robot on and in this network? 'ur use sim' selects the simulated robot",
                    )
                ) from None
            if not told:
                console.warn(f"waiting for the master at {master.uri}")
                console.finish(1.0)
                told = True
            time.sleep(0.1)


def find_core(master: Master, world: World, options: Options) -> tuple[Program, ...]:
    """The master and rosout. Raises UserError when they are not installed."""
    rosmaster = shutil.which("rosmaster", path=world.environment.get("PATH"))
    try:
        rosout = world.find_executables("rosout", "rosout")
    except LookupError:
        rosout = ()
    for found, package in ((rosmaster, "python3-rosmaster"), (rosout, "rosout")):
        if not found:
            raise UserError(
                error(
                    f"no ROS master answers at {master.uri}, and package {package}, which starts one, is not installed",
                    rule="no-master",
                    help=f"sudo apt-get install {package}",
                )
            )
    assert rosmaster is not None
    argv = (
        rosmaster,
        "--core",
        "-p",
        str(master.port),
        "-w",
        str(options.workers or WORKERS),
        *options.master_words,
    )
    return (
        Program(Unit(MASTER, core=True, required=True), argv, log_name="master"),
        Program(
            Unit(ROSOUT, core=True, respawn=True),
            (rosout[0], "__name:=rosout"),
            (("ROS_NAMESPACE", None),),
            log_name="rosout-1",
        ),
    )


def core_parameters(world: World, environment: Mapping[str, str]) -> dict[str, ParamValue]:
    """What roscore sets on its master."""
    # What roscore.xml sets by running `rosversion`, line breaks included.
    version = ""
    try:
        text = world.read_bytes(world.find_package("roslaunch") + "/package.xml").decode("utf-8", "replace")
        version = text.partition("<version>")[2].partition("</version>")[0].strip()
    except (LookupError, OSError):
        version = "<unknown>"
    return {"/rosdistro": environment.get("ROS_DISTRO", "Debian") + "\n", "/rosversion": version + "\n"}


def await_master(master: Master, limit: float) -> Event:
    """Ask a master that was started until it answers, or a time limit (s) is over."""
    end = time.monotonic() + limit
    while time.monotonic() < end:
        try:
            master.call("getPid")
        except (Unanswered, Refused):  # noqa: PERF203 - asking again is the point
            time.sleep(0.005)
        else:
            return MasterAnswered()
    return SetupFailed(f"the master at {master.uri} did not answer within {limit:g} s")
