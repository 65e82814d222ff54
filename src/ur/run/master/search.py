"""Search for the master of a run: its address, its answer, and other programs that listen there."""

import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

from ur.launchfile.plan.specs import ParamValue
from ur.launchfile.world import World
from ur.run.master.client import DEFAULT_PORT, Master, format_master_uri, parse_master_uri
from ur.run.master.xml_rpc import CallRefused, SilentServer, Unanswered, WrongServer
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.run.paths import is_local_address
from ur.run.process.command import UnitProgram
from ur.run.supervisor.events import Event, MasterAnswered, SetupFailed
from ur.run.supervisor.state import Unit
from ur.source.data_classes import dataclass, replace
from ur.source.diagnostic import UserError, user_error
from ur.source.printable import printable
from ur.source.project import launch_library
from ur.system.ros import MASTER_WORKERS, QUIET_MASTER

NAMED_SECONDS = 1.5  # s after which a silent server is named: a master answers within milliseconds
BUSY_SECONDS = 3.0  # s for which a silent server may be a busy or ending master


@dataclass(frozen=True, slots=True)
class Patience:
    """Times (s) after which a silent server is `named`, and for which it may be a `busy` master."""

    named: float = NAMED_SECONDS
    busy: float = BUSY_SECONDS


_PATIENCE = Patience()
_LISTEN = "0A"  # the state of a socket in /proc/net/tcp, proc(5)


def find_master(environment: Mapping[str, str], options: RunOptions) -> Master:
    """Find the master of a run, which may not run yet. Raises UserError for an invalid ROS_MASTER_URI."""
    master = parse_master_uri(environment.get("ROS_MASTER_URI") or f"http://localhost:{DEFAULT_PORT}")
    if options.port is None:
        return master
    return parse_master_uri(format_master_uri(master.host, options.port))


def read_run_id(master: Master, options: RunOptions, console: Console, patience: Patience = _PATIENCE) -> str | None:
    """Return the run id of the present master, '' if it has none; None if a new master may be started.

    A server that does not answer is soon named in a message, and polled for a while, since it may be a busy master. So
    is one that closes connections, or accepts no more of them. Raises UserError for a server that is no master, and for
    a master on another computer that does not answer.
    """
    # A local server is named sooner than a robot behind a slow network is declared unreachable.
    timeout = min(master.timeout, patience.named)
    began = time.monotonic()
    warned = False
    while True:
        try:
            return replace(master, timeout=timeout).get_run_id() or ""
        except Unanswered as problem:  # noqa: PERF203 - asking again is the point
            late = time.monotonic() - began
            local = is_local_address(master.host)
            wrong = local and (isinstance(problem, WrongServer) or any(_listening(master.port)))
            if not options.wait_for_master:
                if not local and (late >= master.timeout or late < timeout):
                    raise _no_master(master, problem) from None
                if local and not wrong:
                    return None
                is_answer = isinstance(problem, WrongServer) and not isinstance(problem, SilentServer)
                if wrong and late > (patience.named if is_answer else patience.busy):
                    raise _wrong_server(master) from None
            if not warned and (options.wait_for_master or (wrong and late >= timeout)):
                console.warn(_describe_server(master) if wrong else f"waiting for the master at {master.uri}")
                console.finish(1.0)
                warned = True
            timeout = timeout if local else master.timeout
            time.sleep(0.1)


def find_listener(port: int) -> str | None:
    """Return the process of this computer that listens on a TCP port, as `NAME, process ID`; None if unknown.

    Only root can see processes of other users.
    """
    sockets = {f"socket:[{inode}]" for inode in _listening(port)}
    for folder in Path("/proc").iterdir():
        if sockets and folder.name.isdigit():
            with suppress(OSError):
                if not sockets.isdisjoint(_open_files(folder / "fd")):
                    name = (folder / "comm").read_text(encoding="utf-8", errors="replace").strip()
                    return f"{printable(name)}, process {folder.name}"
    return None


def _open_files(folder: Path) -> Iterator[str]:
    for each in folder.iterdir():
        with suppress(FileNotFoundError):  # the file was closed meanwhile
            yield str(each.readlink())


def _listening(port: int) -> Iterator[str]:
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        with suppress(OSError):
            for line in Path(table).read_text(encoding="ascii").splitlines()[1:]:
                words = line.split()
                if words[3] == _LISTEN and int(words[1].rpartition(":")[2], 16) == port:
                    yield words[9]


def _describe_server(master: Master) -> str:
    place = master.uri.removeprefix("http://").rstrip("/")
    listener = find_listener(master.port)
    return f"a server that does not answer as a ROS master listens on {place}" + (f" ({listener})" if listener else "")


def _wrong_server(master: Master) -> UserError:
    who = "" if find_listener(master.port) else f"; sudo ss -ltnp 'sport = :{master.port}' names it"
    return user_error(
        f"{_describe_server(master)}, expected a ROS master or a free port",
        rule="no-master",
        help=f"end that process{who}; or use another port: ur launch -p {master.port + 1} ...",
    )


def _no_master(master: Master, problem: Unanswered) -> UserError:
    return user_error(
        f"no ROS master answers at {master.uri}: {problem}",
        rule="no-master",
        help="is the robot on and in this network? 'ur use sim' selects the simulated robot",
        subject=master.uri,
    )


MASTER = "master"
ROSOUT = "/rosout"


def find_master_programs(master: Master, world: World, options: RunOptions) -> tuple[UnitProgram, ...]:
    """Return the programs of master and rosout.

    Raises UserError if they are missing, or cannot listen at that address.
    """
    if ":" in master.host and world.environment.get("ROS_IPV6") != "on":
        raise user_error(
            f"no ROS master answers at {master.uri}, and one that is started here does not listen on IPv6",
            rule="no-master",
            help=f"export ROS_IPV6=on; or use IPv4: export ROS_MASTER_URI=http://localhost:{master.port}",
        )
    rosmaster = shutil.which("rosmaster", path=world.environment.get("PATH"))
    try:
        rosout = world.find_executables("rosout", "rosout")
    except LookupError:
        rosout = ()
    for found, package in ((rosmaster, "python3-rosmaster"), (rosout, "rosout")):
        if not found:
            raise user_error(
                f"no ROS master answers at {master.uri}, and package {package}, which starts one, is not installed",
                rule="no-master",
                help=f"sudo apt-get install {package}",
            )
    assert rosmaster is not None
    argv = (
        rosmaster,
        "--core",
        "-p",
        str(master.port),
        "-w",
        str(options.workers or MASTER_WORKERS),
        *QUIET_MASTER,
        *options.master_words,  # the last level counts
    )
    slim: tuple[tuple[str, str | None], ...] = (("MALLOC_ARENA_MAX", "1"),)
    own = Path(world.environment.get("ROS_HOME") or Path.home() / ".ros", "config")
    if "ROS_PYTHON_LOG_CONFIG_FILE" not in world.environment and not own.is_dir():
        library = launch_library() / "lib"
        path = ":".join(filter(None, (str(library / "master_modules"), world.environment.get("PYTHONPATH"))))
        slim += (("ROS_PYTHON_LOG_CONFIG_FILE", str(library / "master_log.conf")), ("PYTHONPATH", path))
    return (
        UnitProgram(Unit(MASTER, core=True, required=True), argv, slim, log_name="master"),
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
