"""One of two computers: its facts, and its view of the other. Values only."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from ur.robot.doctor.messages import Message
from ur.robot.doctor.wifi import WirelessLink
from ur.robot.ros2.seen_graph import Ros2
from ur.system.releases import System

ROS_1 = ("python3-roslaunch", "ros-noetic-roslaunch", "ros-one-roslaunch")  # packages that show it


@dataclass(frozen=True, slots=True)
class Disk:
    """A file system by its mount point: free space (MB) and used fraction (0..1)."""

    place: str
    free: float
    used: float


@dataclass(frozen=True, slots=True)
class FailedUnit:
    """A systemd unit that fails: the number of its restarts, and its last lines in the journal."""

    name: str
    restarts: int = 0
    last: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Setting:
    """A line of a shell start-up file that sets a ROS variable. The file is written as shells read it: ~/ is home."""

    file: str
    variable: str


@dataclass(frozen=True, slots=True)
class Side:
    """One computer. Times in s, sizes in MB; None, or empty, for what could not be observed.

    `resolves` are the addresses to which this computer resolves the other's full name. `ros` is the environment of
    nodes that roslaunch starts (on this computer: of the shell that called the doctor), `shell` that of a new terminal;
    `settings` are the lines that define them, `ros_setup` the text of ~/.ros_setup. `modes` are the permissions of the
    files that ssh is strict about, relative to the home folder. `own_login` is ssh's output when the computer logged in
    to itself by its full name, '' on success. `large` are folders that may be emptied, with their sizes. `packages` are
    Debian packages with their versions, `workspace` those below ~/catkin_ws/src, which is `built` or not; `ur` is the
    version that set the robot up. `device` is the network device towards the other computer. `ros2` is its ROS 2,
    `observed` the output of scripts that rules declare, by name.
    """

    name: str
    user: str = ""
    addresses: tuple[str, ...] = ()
    resolves: frozenset[str] = frozenset()
    ros: Mapping[str, str] = field(default_factory=dict)
    shell: Mapping[str, str] = field(default_factory=dict)
    settings: tuple[Setting, ...] = ()
    ros_setup: str | None = None
    modes: Mapping[str, int] = field(default_factory=dict)
    own_login: str = ""
    host_key: str = ""
    public_key: str = ""
    x11: bool | None = None
    active: Mapping[str, str] = field(default_factory=dict)
    failing: tuple[FailedUnit, ...] = ()
    announced: str = ""
    disks: tuple[Disk, ...] = ()
    large: Mapping[str, float] = field(default_factory=dict)
    memory_free: float | None = None
    loss: float | None = None
    latency: float | None = None
    device: str = ""
    mtu: int | None = None
    full_frames: bool | None = None
    firewall: str = ""
    packages: Mapping[str, str] = field(default_factory=dict)
    messages: Mapping[str, Message] = field(default_factory=dict)
    built: bool = False
    workspace: frozenset[str] = frozenset()
    system: str = ""
    release: System | None = None
    ur: str = ""
    wifi: tuple[WirelessLink, ...] = ()
    ros2: Ros2 = field(default_factory=Ros2)
    observed: Mapping[str, str] = field(default_factory=dict)

    @property
    def only_ros2(self) -> bool:
        """Return whether it has ROS 2 and no ROS 1."""
        return self.ros2.present and not any(name in self.packages for name in ROS_1)
