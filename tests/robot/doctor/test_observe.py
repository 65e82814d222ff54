"""What a computer answers is read as it was said."""

import subprocess
from pathlib import Path

import pytest

from ur.robot.doctor.messages import MESSAGES_SCRIPT, Message, parse_messages
from ur.robot.doctor.observe import observe_script, parse_side
from ur.robot.doctor.rules import OBSERVE
from ur.robot.doctor.side import Disk, FailedUnit, Setting, Side


def test_what_was_not_seen_stays_unknown() -> None:
    assert parse_side("") == Side("")


def test_side_is_read_from_the_answer_of_a_computer() -> None:
    side = parse_side(Path(__file__).with_name("side.txt").read_bytes().decode(), ["throttled"])
    assert side == Side(
        "bob",
        "ros",
        ("10.0.0.2",),
        frozenset({"10.0.0.1"}),
        ros={"ROS_MASTER_URI": "http://bob.local:11311"},
        shell={"ROS_IP": "10.0.0.9"},
        settings=(Setting("/home/ros/.bashrc", "ROS_IP"),),
        ros_setup="export A=1\n",
        modes={".": 0o755, ".ssh": 0o700},
        own_login="ros@bob.local: Permission denied (publickey).",
        host_key="ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIEFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFB",
        public_key="ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIEJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJC ros@bob",
        x11=True,
        active={"ssh.service": "active"},
        failing=(FailedUnit("a.service", 0), FailedUnit("ubiquity-drive.service", 12)),
        announced="bob",
        disks=(Disk("/", 100.0, 0.9), Disk("/home/ros of mine", 0.0, 1.0)),
        large={"/home/ros/.ros/log": 70.0},
        memory_free=2.0,
        loss=0.2,
        latency=0.004,
        device="host0",
        mtu=1500,
        full_frames=False,
        firewall="nft",
        observed={"throttled": "throttled=0x50005\n"},
        packages={"ros-std-msgs": "0.5"},
        messages={"std_msgs/String.msg": Message("0123", "/usr/share/std_msgs")},
        built=True,
        workspace=frozenset({"my_msgs"}),
        system="Debian GNU/Linux 12 aarch64",
        ur="0.1.0",
    )


def test_script_gets_to_its_end_in_a_plain_shell() -> None:
    done = subprocess.run(["sh", "-c", observe_script("", OBSERVE)], capture_output=True, text=True, check=False)
    side = parse_side(done.stdout)
    assert done.stdout.endswith("\x1eend\n")
    assert side.name == Path("/proc/sys/kernel/hostname").read_text().strip()
    assert any(disk.place == "/" for disk in side.disks)


def test_definitions_that_differ_in_comments_and_blanks_are_the_same(tmp_path: Path) -> None:
    found = []
    for number, text in enumerate(("int32 x # metres\n\n", "# a comment\nint32   x\n", "int64 x\n")):
        folder = tmp_path / str(number) / "my_msgs"
        (folder / "msg").mkdir(parents=True)
        (folder / "package.xml").write_text("<package/>")
        (folder / "msg" / "X.msg").write_text(text)
        environment = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "ROS_PACKAGE_PATH": str(folder.parent)}
        done = subprocess.run(
            ["sh", "-c", MESSAGES_SCRIPT], capture_output=True, text=True, env=environment, check=True
        )
        found.append(parse_messages(done.stdout)["my_msgs/X.msg"])
    assert found[0].digest == found[1].digest != found[2].digest
    assert found[0].folder == "~/0/my_msgs"


@pytest.mark.parametrize("lie", ["modes\nrwx .ssh\n", "disk\nx 1 x ² x /\n", "large\nx\ty\n"])
def test_answer_that_makes_no_sense_stays_unknown(lie: str) -> None:
    nothing = parse_side("\x1eend\n")
    assert parse_side(f"\x1e{lie}\x1eend\n") == nothing
