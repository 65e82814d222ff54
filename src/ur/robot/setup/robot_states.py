"""The wanted state of a robot."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version

from ur.devices.known import Expected
from ur.devices.needs import RELOAD, write_rules
from ur.devices.observe import RULES_FILE
from ur.robot.boot.units import master_unit
from ur.robot.robot_file import ROBOT_FILE, Ros2Robot
from ur.robot.setup.access_point import access_point_request, want_access_point
from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.environment import robot_environment
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.keys import HOST_KEY, KEY, allowed_key, known_host, own_keys
from ur.robot.setup.packages import WantedPackages, WantedService
from ur.robot.setup.raspberry_pi import header
from ur.robot.setup.wanted import Wanted, WantedFile, WantedFolder, WantedGroups, WantedLine
from ur.robot.ssh.secret import Secret

SERVICE_TYPE = "_ubiquity-robot._tcp"
PACKAGES = (
    *("openssh-server", "avahi-daemon", "libnss-mdns", "chrony", "xauth", "x11-apps", "rsync", "python3"),
    *("python3-rospy", "python3-roslaunch", "python3-rosmaster", "python3-rostopic", "python3-rosnode"),
    *("python3-rosparam", "python3-rosservice", "python3-rosmsg", "python3-rosgraph", "python3-message-filters"),
    *("python3-rosbag", "python3-rosclean", "python3-roswtf", "rosout", "topic-tools", "libtopic-tools-dev"),
    *("ros-robot-state-publisher|robot-state-publisher", "iw", "catkin", "cmake", "g++", "make"),
)
# Required by programs of this project in addition: the packages of tools/set_up.bash.
PROGRAM_PACKAGES = (
    *("python3-venv", "ca-certificates", "rosbash", "python3-tf2-ros", "python3-actionlib", "python3-geometry-msgs"),
    *("python3-nav-msgs", "python3-sensor-msgs", "python3-move-base-msgs", "python3-visualization-msgs"),
    *("python3-std-srvs", "python3-dynamic-reconfigure|python3-rospy"),
)
GROUPS = ("dialout", "video", "plugdev", "input", "gpio", "i2c")
_OURS = r"(?m)^(?:(?:name|base|variant|ros|ros_[a-z]+)[ \t]*:.*|# .* Written by ur robot setup\.)\n?"
CLOUD = "/etc/cloud/cloud.cfg"
AVAHI = "/etc/avahi/avahi-daemon.conf"
KEEP_NAME = "# Written by ur robot setup.\npreserve_hostname: true\nmanage_etc_hosts: false\n"


@dataclass(frozen=True, slots=True)
class ViewerFacts:
    """The facts that a robot needs about the viewer, the user's computer.

    `host_key` is None if no ssh server is installed.
    """

    user: str
    name: str
    public_key: str
    host_key: str | None


@dataclass(frozen=True, slots=True)
class WantedRobot:
    """The wanted name and base of a robot.

    With `master`, a ROS master runs from boot on. With `programs`, the requirements of this project's programs are
    installed. `ros2` is its present ROS 2; None: the set-up installs ROS 1. `access_point` None: as it is, else on.
    """

    name: str
    base: str
    variant: str = ""
    master: bool = True
    programs: bool = True
    ros2: Ros2Robot | None = None
    access_point: bool | None = None


@dataclass(frozen=True, slots=True)
class WantedPassword:
    """The password of the user. It cannot be read, so `is_set` is determined by comparing."""

    password: Secret
    is_set: bool
    title: str = "password"

    def request(self, user: str) -> FactsRequest:
        """Request no facts."""
        return FactsRequest(user)

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Set the password, through standard input."""
        if self.is_set:
            return None
        line = Secret(f"{facts.user}:{self.password.reveal()}\n")
        command = ChangeScript("chpasswd", root=True, stdin=line)
        return Change(self.title, f"new password for {facts.user}", (command,))

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: the password stays."""
        return None


def is_robot_name(text: str) -> bool:
    """Return whether a text is a valid robot name: a host name of one label (RFC 1123), in lower case."""
    return re.fullmatch(r"[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?", text) is not None


def base_request(user: str) -> FactsRequest:
    """Return the facts that `wanted_there` needs."""
    files = frozenset({HOST_KEY, KEY + ".pub", CLOUD, AVAHI, str(ROBOT_FILE)})
    return FactsRequest(user, files=files | header.FILES) | access_point_request(user)


def wanted_there(
    facts: ComputerFacts,
    robot: WantedRobot,
    viewer: ViewerFacts,
    password: WantedPassword | None,
    *,
    library: Sequence[Wanted] = (),
    devices: Sequence[Expected] = (),
) -> list[Wanted]:
    """Return the robot's wanted states in the order of their application: the login first, the name last.

    `library` is the copy of this project and its environment; `devices` are those that its base needs, which get stable
    names. The new name takes effect at the next boot. Until then, after an interruption at any point, the robot has its
    old name; from the first change on it accepts the viewer's key.
    """
    items: list[Wanted] = [
        WantedFolder("ssh folder", "~/.ssh", mode=0o700),
        allowed_key("login from the viewer", viewer.public_key),
        WantedFile("robot file", str(ROBOT_FILE), robot_file(robot, facts.file(str(ROBOT_FILE)).text)),
        WantedPackages("packages", PACKAGES + (PROGRAM_PACKAGES if robot.programs else ())),
        WantedService("ssh server", "ssh.service"),
        WantedService("names ending in .local", "avahi-daemon.service"),
        WantedFile("announcement", "/etc/avahi/services/ubiquity.service", announcement(robot, facts.user)),
        WantedFile(
            "X11 over ssh", "/etc/ssh/sshd_config.d/60-ubiquity.conf", SSHD, then="systemctl try-reload-or-restart ssh"
        ),
        WantedFile(
            "time from the viewer",
            "/etc/chrony/conf.d/ubiquity.conf",
            time_source(viewer),
            then="systemctl try-restart chrony",
        ),
        WantedService("time", "chrony.service"),
        WantedGroups("groups", GROUPS),
        # Without udev, as in a container, the rules have no effect, which is no error.
        WantedFile("names of devices", RULES_FILE, write_rules(devices), then=f"{{ {RELOAD}; }} 2>/dev/null || :"),
        *header.want_header(facts, devices),
        *robot_environment(),
        *own_keys(facts.user, robot.name, facts.file(HOST_KEY).text),
    ]
    if viewer.host_key:
        items.append(known_host("host key of the viewer", viewer.name, viewer.host_key))
    if robot.master:
        items += boot_master(facts.user, facts.home)
    if password:
        items.append(password)
    items += [*want_access_point(facts, robot.access_point), *library]
    if facts.file(CLOUD).text is not None:
        items.append(WantedFile("cloud-init", "/etc/cloud/cloud.cfg.d/99-ubiquity.cfg", KEEP_NAME))
    avahi = facts.file(AVAHI).text or ""
    if follow_host_name(avahi) != avahi:
        items.append(WantedFile("host name (avahi)", AVAHI, follow_host_name(avahi)))
    items += [
        WantedLine("host name (hosts)", "/etc/hosts", f"127.0.1.1\t{robot.name}", old=("127.0.1.1",)),
        WantedFile("host name", "/etc/hostname", f"{robot.name}\n"),
    ]
    return items


def follow_host_name(settings: str) -> str:
    """Return Avahi's settings without a separate host name, which would be announced in place of the computer's."""
    return re.sub(r"(?m)^([ \t]*host-name[ \t]*=)", r"#\1", settings)


def boot_master(user: str, home: str) -> list[Wanted]:
    """Return the states for a ROS master that runs from boot on, so that viewers and programs find one."""
    unit = master_unit(user, home)
    service = f"{unit.service}.service"
    reload = f"systemctl daemon-reload; systemctl try-restart {service}"
    return [WantedFile("ROS master at boot", unit.path, unit.text, then=reload), WantedService("ROS master", service)]


def robot_file(robot: WantedRobot, present: str | None = None) -> str:
    """Return the text of robot.yaml. Other entries of the present file, such as devices, stay.

    Names and bases are plain words, which YAML might read as numbers or booleans: they are quoted.
    """
    head = "# What this robot is; read by ur. Written by ur robot setup.\n"
    rows = {"name": robot.name, "base": robot.base, "variant": robot.variant}
    rows |= robot.ros2.rows() if robot.ros2 else {}
    ours = "".join(f'{key}: "{value}"\n' for key, value in rows.items() if value)
    return head + ours + re.sub(_OURS, "", present or "")


def announcement(robot: WantedRobot, user: str) -> str:
    """Return the Avahi service by which viewers find the robot. `version` is that of the `ur` that set it up."""
    own = {"name": robot.name, "base": robot.base, "variant": robot.variant, "user": user}
    records = {**own, "ros": robot.ros2.distro if robot.ros2 else "", "version": version("ubiquity-launches")}
    texts = "".join(f"    <txt-record>{key}={value}</txt-record>\n" for key, value in records.items() if value)
    return (
        '<?xml version="1.0" standalone="no"?>\n<!DOCTYPE service-group SYSTEM "avahi-service.dtd">\n'
        '<!-- Written by ur robot setup. -->\n<service-group>\n  <name replace-wildcards="yes">%h</name>\n'
        f"  <service>\n    <type>{SERVICE_TYPE}</type>\n    <port>22</port>\n{texts}  </service>\n</service-group>\n"
    )


def time_source(viewer: ViewerFacts) -> str:
    """Return Chrony's settings: the viewer is the time source if there is no better one, as without internet."""
    return (
        "# Written by ur robot setup. The viewer's time, where no server of the internet answers.\n"
        f"server {viewer.name}.local iburst minpoll 3 maxpoll 6\n"
        "# A robot without a clock of its own starts years ago: step, then be smooth.\nmakestep 1 3\n"
    )


SSHD = """\
# Written by ur robot setup: windows of programs on the robot open on the viewer.
X11Forwarding yes
X11UseLocalhost yes
"""
