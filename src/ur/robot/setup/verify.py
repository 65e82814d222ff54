"""Verification of a robot from both ends, as a user and a ROS node would use it."""

from collections.abc import Callable
from dataclasses import dataclass

from ur.robot.boot.units import LIBRARIES
from ur.robot.discovery.ask import clock_offset
from ur.robot.robot_file import ROBOT_FILE
from ur.robot.setup.login import Task
from ur.robot.setup.robot_states import SERVICE_TYPE, ViewerFacts, robot_file
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import Shell, quote

STRICT = "ssh -T -o BatchMode=yes -o StrictHostKeyChecking=yes -o ConnectTimeout=10 -o LogLevel=ERROR --"
CLOCK_SECONDS = 0.5
# The modules of a typical program: ROS, its messages, the simulator, the nodes.
_PROGRAMS = f"""\
for d in {" ".join(f'"$HOME"/{place}' for place in LIBRARIES)}; do
  [ -r "$d/.venv/ready-run" ] || continue
  "$d/.venv/bin/python" -I -c "import rospy, actionlib, tf2_ros, geometry_msgs.msg, nav_msgs.msg, sensor_msgs.msg, \
move_base_msgs.msg, visualization_msgs.msg, std_srvs.srv, numpy, scipy, mujoco, ur_nodes" || exit
  "$d/.venv/bin/python" -I -m ur --version || exit
  read -r copy 2>/dev/null <"$d/.copy" && echo "copy $(echo "$copy" | cut -c-7)" || echo "the clone $d"
  exit
done
echo "nothing is set up there" >&2; exit 1"""

_PROGRAMS_ROS2 = f"""\
for d in {" ".join(f'"$HOME"/{place}' for place in LIBRARIES)}; do
  [ -r "$d/.venv/ready-run" ] || continue
  "$d/.venv/bin/python" -I -c "import rclpy, geometry_msgs.msg, sensor_msgs.msg, nav_msgs.msg, numpy, ur_nodes" || exit
  "$d/.venv/bin/python" -I -m ur --version || exit
  exit
done
echo "nothing is set up there" >&2; exit 1"""


@dataclass(frozen=True, slots=True)
class Check:
    """One check: its subject, the computer that made it, whether it passed, and the observation."""

    title: str
    place: str
    good: bool
    seen: str


def verify(
    task: Task, here: Shell, there: SshShell, viewer: ViewerFacts, find_master: Callable[[str], bool]
) -> list[Check]:
    """Return all checks, passed or failed. Raises UserError only if the connection breaks.

    `find_master` waits until a host's ROS master answers this computer; it starts after the network is up.
    """
    if task.robot.ros2:
        return _verify_ros2(task, here, there)
    name, user = task.robot.name, task.address.user
    robot, laptop = f"{name}.local", f"{viewer.name}.local"
    checks = [
        _expect(there, "host name", "cat /proc/sys/kernel/hostname /etc/hostname", f"{name}\n{name}"),
        _file(there, task),
        _succeed(here, f"name {robot}", f"getent ahostsv4 {quote(robot)}", first=True),
        _succeed(there, f"name {laptop}", f"getent ahostsv4 {quote(laptop)}", first=True),
        _expect(here, "login by key", f"{STRICT} {quote(f'{user}@{robot}')} cat /proc/sys/kernel/hostname", name),
        _expect(there, "login to itself", f"{STRICT} {quote(f'{user}@{robot}')} cat /proc/sys/kernel/hostname", name),
        _ros(here, f"{user}@{robot}", f"http://{robot}:11311 {robot}"),
        _succeed(there, "ROS", "command -v roscore rostopic rosrun", first=True),
        _succeed(there, "X11", "command -v xauth", first=True),
        _expect(there, "time", "systemctl is-active chrony", "active"),
        _clock(here, there),
        _succeed(
            there, "announcement", f"systemctl is-active avahi-daemon && grep -o {SERVICE_TYPE} /etc/avahi/services/*"
        ),
    ]
    if task.robot.master:
        found = find_master(robot)
        checks.append(Check("ROS master", here.destination, found, f"http://{robot}:11311" if found else "no answer"))
        checks.append(_expect(there, "ROS master at boot", "systemctl is-enabled ubiquity-master", "enabled"))
    if task.robot.programs:
        done = there.run(quote("bash", "-lc", _PROGRAMS), timeout=120.0)
        last = (done.err.strip().splitlines() or [f"exit code {done.code}"])[-1]
        checks.append(Check("programs", there.destination, done.code == 0, _one_line(last if done.code else done.out)))
    if task.robot_login and viewer.host_key:
        login = f"{STRICT} {quote(f'{viewer.user}@{laptop}')} cat /proc/sys/kernel/hostname"
        checks.append(_expect(there, "login by key", login, viewer.name))
    elif task.robot_login:
        checks.append(Check("login by key", there.destination, False, "no ssh server on this computer; run: ur setup"))
    return checks


def _verify_ros2(task: Task, here: Shell, there: SshShell) -> list[Check]:
    name, user = task.robot.name, task.address.user
    login = f"{STRICT} {quote(f'{user}@{name}.local')} cat /proc/sys/kernel/hostname"
    served = f"systemctl is-active avahi-daemon && grep -o {SERVICE_TYPE} /etc/avahi/services/*"
    assert task.robot.ros2
    setup = f"/opt/ros/{task.robot.ros2.distro}/setup.bash"
    nodes = f". {setup} >/dev/null && cd / && "
    checks = [
        _expect(there, "host name", "cat /proc/sys/kernel/hostname", name),
        _file(there, task),
        _succeed(here, f"name {name}.local", f"getent ahostsv4 {quote(f'{name}.local')}", first=True),
        _expect(here, "login by key", login, name),
        _succeed(there, "announcement", served),
    ]
    if task.robot.programs:
        done = there.run(quote("bash", "-c", nodes + _PROGRAMS_ROS2), timeout=120.0)
        last = (done.err.strip().splitlines() or [f"exit code {done.code}"])[-1]
        checks.append(Check("programs", there.destination, done.code == 0, _one_line(last if done.code else done.out)))
    return checks


def _expect(shell: Shell, title: str, script: str, wanted: str) -> Check:
    done = shell.run(script)
    reported = done.out.strip()
    good = done.code == 0 and reported == wanted
    seen = _one_line(reported) if good else _one_line(done.err.strip() or reported or f"exit code {done.code}")
    return Check(title, shell.destination, good, seen)


def _succeed(shell: Shell, title: str, script: str, *, first: bool = False) -> Check:
    done = shell.run(script)
    reported = _one_line(done.out.strip().splitlines()[0].split()[0] if first and done.out.strip() else done.out)
    return Check(
        title,
        shell.destination,
        done.code == 0,
        reported if done.code == 0 else reported or _one_line(done.err) or "nothing",
    )


def _file(there: Shell, task: Task) -> Check:
    done = there.run(f"cat {ROBOT_FILE}")
    good = done.code == 0 and done.out == robot_file(task.robot, done.out)
    return Check("robot file", there.destination, good, "as wanted" if good else _one_line(done.err or done.out))


def _ros(here: Shell, robot: str, wanted: str) -> Check:
    # As roslaunch starts nodes: a shell that is neither interactive nor a login shell.
    return _expect(here, "ROS environment", f"{STRICT} {quote(robot)} 'echo $ROS_MASTER_URI $ROS_HOSTNAME'", wanted)


def _clock(here: Shell, there: Shell) -> Check:
    before = here.run("date +%s.%N").out
    middle = there.run("date +%s.%N").out
    after = here.run("date +%s.%N").out
    try:
        offset = clock_offset(float(before), float(middle), float(after))
    except ValueError:
        return Check("clock", there.destination, False, f"not a time: {_one_line(middle)}")
    return Check("clock", there.destination, abs(offset) < CLOCK_SECONDS, f"{offset:+.3f} s")


def _one_line(text: str) -> str:
    return " ".join(text.split())[:100]
