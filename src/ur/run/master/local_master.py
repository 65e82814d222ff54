"""The master of a run: an existing one, or a new one together with rosout."""

from __future__ import annotations

import shutil
import time
from collections.abc import Mapping

from ur.launchfile.plan.specs import ParamValue
from ur.launchfile.world import World
from ur.run.master.client import Master
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.options import RunOptions
from ur.run.process.command import UnitProgram
from ur.run.supervisor.events import Event, MasterAnswered, SetupFailed
from ur.run.supervisor.state import Unit
from ur.source.diagnostic import UserError, error

MASTER = "master"
ROSOUT = "/rosout"


def find_master_programs(master: Master, world: World, options: RunOptions) -> tuple[UnitProgram, ...]:
    """Return the programs of master and rosout.

    Raises UserError if they are missing, or cannot listen at that address.
    """
    if ":" in master.host and world.environment.get("ROS_IPV6") != "on":
        raise UserError(
            error(
                f"no ROS master answers at {master.uri}, and one that is started here does not listen on IPv6",
                rule="no-master",
                help=f"export ROS_IPV6=on; or use IPv4: export ROS_MASTER_URI=http://localhost:{master.port}",
            )
        )
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
    from ur.robot.boot.units import MASTER_WORKERS  # imported late: only if a master is started

    argv = (
        rosmaster,
        "--core",
        "-p",
        str(master.port),
        "-w",
        str(options.workers or MASTER_WORKERS),
        *options.master_words,
    )
    return (
        UnitProgram(Unit(MASTER, core=True, required=True), argv, log_name="master"),
        UnitProgram(
            Unit(ROSOUT, core=True, respawn=True),
            (rosout[0], "__name:=rosout"),
            (("ROS_NAMESPACE", None),),
            log_name="rosout-1",
        ),
    )


def roscore_parameters(world: World, environment: Mapping[str, str]) -> dict[str, ParamValue]:
    """Return the parameters that roscore sets on its master."""
    # The values that roscore.xml sets from `rosversion`, line breaks included.
    version = ""
    try:
        text = world.read_bytes(world.find_package("roslaunch") + "/package.xml").decode("utf-8", "replace")
        version = text.partition("<version>")[2].partition("</version>")[0].strip()
    except (LookupError, OSError):
        version = "<unknown>"
    return {"/rosdistro": environment.get("ROS_DISTRO", "Debian") + "\n", "/rosversion": version + "\n"}


def await_master(master: Master, limit: float) -> Event:
    """Poll a started master until it answers, or a time limit (s) has passed."""
    end = time.monotonic() + limit
    while time.monotonic() < end:
        try:
            master.call("getPid")
        except (Unanswered, CallRefused):  # noqa: PERF203 - asking again is the point
            time.sleep(0.005)
        else:
            return MasterAnswered()
    return SetupFailed(f"the master at {master.uri} did not answer within {limit:g} s")
