"""A healthy pair of computers, from which tests take something away."""

from dataclasses import replace

from ur.robot.doctor.findings import ComputerPair
from ur.robot.doctor.messages import Message
from ur.robot.doctor.side import Disk, Side
from ur.robot.doctor.wifi import WirelessLink
from ur.robot.setup import robot_states as remote
from ur.robot.setup import viewer_states as local
from ur.robot.setup.environment import robot_setup_text

ACTIVE = {"ssh.service": "active", "avahi-daemon.service": "active", "chrony.service": "active"}
LAPTOP = Side(
    "laptop",
    "pat",
    ("10.0.0.1",),
    frozenset({"10.0.0.2"}),
    ros={"ROS_MASTER_URI": "http://bob.local:11311", "ROS_HOSTNAME": "laptop.local"},
    modes={".": 0o755, ".ssh": 0o700, ".ssh/id_ed25519": 0o600},
    host_key="ssh-ed25519 LLLL",
    public_key="ssh-ed25519 PPPP pat@laptop",
    x11=True,
    active=ACTIVE,
    announced="laptop",
    disks=(Disk("/", 9000.0, 0.5),),
    memory_free=2000.0,
    loss=0.0,
    latency=0.002,
    device="wlan0",
    mtu=1500,
    full_frames=True,
    firewall="nft",
    packages={entry.split("|")[0]: "1" for entry in local.PACKAGES},
    messages={"std_msgs/String.msg": Message("abc", "/usr/share/std_msgs")},
)
ROBOT = replace(
    LAPTOP,
    name="bob",
    user="ros",
    addresses=("10.0.0.2",),
    resolves=frozenset({"10.0.0.1"}),
    ros={"ROS_MASTER_URI": "http://bob.local:11311", "ROS_HOSTNAME": "bob.local"},
    ros_setup=robot_setup_text(),
    announced="bob",
    host_key="ssh-ed25519 RRRR",
    public_key="ssh-ed25519 QQQQ ros@bob",
    packages={entry.split("|")[0]: "1" for entry in remote.PACKAGES},
)
PAIR = ComputerPair(
    LAPTOP,
    ROBOT,
    offset=0.0,
    way_back="",
    reaches_remote=True,
    reaches_local=True,
    known=True,
    selected=True,
    login="ros@bob.local",
)
WIFI = WirelessLink("wlan0", 5180.0, -50.0, 400.0, power_save=False)
NOBODY: frozenset[str] = frozenset()
BOB = frozenset({"10.0.0.2"})
