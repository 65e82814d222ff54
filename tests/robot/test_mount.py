"""Mount command lines, and reading what is mounted."""

from pathlib import Path

from ur.robot.mount import MountedFolder, mount_command, mounts_of, parse_mounts
from ur.robot.ssh.address import Address

MOUNTS = """\
/dev/sda1 / ext4 rw 0 0
ros@bob.local:catkin_ws/src /home/pat/my\\040robots/bob fuse.sshfs rw,nosuid 0 0
bobby.local: /mnt fuse.sshfs rw 0 0
"""


def test_mounts_are_read_with_their_blanks() -> None:
    mounts = parse_mounts(MOUNTS)
    assert mounts[0] == MountedFolder("ros@bob.local:catkin_ws/src", Path("/home/pat/my robots/bob"))
    assert mounts_of(mounts, "bob.local") == mounts[:1]
    assert mounts_of(mounts, "bobby.local") == mounts[1:]


def test_mount_gives_up_on_a_silent_network_and_on_unknown_host_keys() -> None:
    words = mount_command(Address("ros", "bob.local"), "catkin_ws/src", Path("/mnt"))
    assert words[:3] == ["sshfs", "ros@bob.local:catkin_ws/src", "/mnt"]
    assert {"reconnect", "ServerAliveInterval=2", "StrictHostKeyChecking=yes"} <= set(words[-1].split(","))
