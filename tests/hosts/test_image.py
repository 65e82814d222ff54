"""`ur image prepare`, and what a computer makes of it when it boots for the first time."""

import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.hosts.bench import UR, Bench, Machine, boot
from tests.hosts.test_robot_setup import SUDO
from tests.robot.image.images import CLOUD_ROOT, make_cloud, needs_tools, read_ext

pytestmark = [needs_tools]
SEED = "var/lib/cloud/seed/nocloud"
IMAGE = "home/pat/cloud.img"
# The image brought its host key: there is no first contact.
KNOWN = "-o BatchMode=yes -o StrictHostKeyChecking=yes -o LogLevel=ERROR"


@dataclass(frozen=True)
class Booted:
    """A laptop, and a robot that booted from the seed that the laptop wrote into an image."""

    laptop: Machine
    robot: Machine


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Booted]:
    with boot(("laptop", "robot")) as bench:
        yield Booted(bench["laptop"], first_boot(bench, tmp_path_factory.mktemp("image")))


def first_boot(bench: Bench, folder: Path) -> Machine:
    laptop, robot = bench["laptop"], bench["robot"]
    laptop.write("/etc/sudoers.d/pat", SUDO, mode=0o440)
    laptop.run("mkdir -m 700 -p .ssh && ssh-keygen -q -t ed25519 -N '' -f .ssh/id_ed25519", user="pat").check()
    laptop.run("apt-get -qq update && apt-get -qqy install mtools", timeout=120).check()
    shutil.copy(make_cloud(folder / "cloud.img"), laptop.root / IMAGE)
    laptop.run(f"chown pat: /{IMAGE}").check()
    laptop.run(command("bob"), user="pat", stdin="\nwifi-secret\n").check()
    transfer(laptop, robot)
    # Of this computer, not of its seed: where it looks for one, and that it has no locales.
    robot.write("/etc/cloud/cloud.cfg.d/90-bench.cfg", "datasource_list: [NoCloud]\nlocale: 'off'\n")
    (robot.root / "etc/cloud/cloud-init.disabled").unlink()
    reboot(robot)
    return robot


def command(name: str, user: str = "rob") -> str:
    who = f"--name {name} --base magni --user {user}"
    return f"{UR} image prepare cloud.img {who} --ssid home --country DE --passwords-from 0"


def transfer(laptop: Machine, robot: Machine) -> None:
    """What was written into the image becomes the robot's disk."""
    for name in ("user-data", "meta-data", "network-config"):
        robot.write(f"/{SEED}/{name}", read_ext(laptop.root / IMAGE, f"{SEED}/{name}", CLOUD_ROOT), mode=0o600)


def reboot(robot: Machine) -> None:
    leader = robot.leader
    robot.run("systemctl reboot --no-block")
    robot.wait_rebooted(leader, deadline=180.0)  # a stop may wait out its 90 s
    robot.wait_for("cloud-init status | grep done", deadline=120.0)


def test_seed_is_what_cloud_init_wants(pair: Booted) -> None:
    pair.robot.run(f"cloud-init schema --config-file /{SEED}/user-data").check()
    log = pair.robot.read("/var/log/cloud-init.log").splitlines()
    pair.robot.run("systemd-analyze verify ubiquity-names.service").check()
    # Networks are netplan's on every image that is supported; here there is none.
    assert [line for line in log if "[WARNING]" in line and "distros with netplan" not in line] == []


def test_robot_has_its_name_user_and_file_after_its_first_boot(pair: Booted) -> None:
    robot = pair.robot
    assert robot.run("cat /etc/hostname /proc/sys/kernel/hostname").out == "bob\nbob\n"
    assert "127.0.1.1\tbob\n" in robot.read("/etc/hosts")
    assert 'name: "bob"\nbase: "magni"\n' in robot.read("/etc/ubiquity/robot.yaml")
    assert robot.run("getent shadow rob").out.startswith("rob:!")
    assert "sudo" in robot.run("id -nG rob").out.split()


def test_laptop_logs_in_by_name_and_key_without_a_password(pair: Booted) -> None:
    laptop = pair.laptop
    laptop.wait_for("getent ahostsv4 bob.local", deadline=60.0)
    done = laptop.run(f"ssh {KNOWN} rob@bob.local 'id -un; sudo -n id -un; cat /proc/sys/kernel/hostname'", user="pat")
    assert done.check().out == "rob\nroot\nbob\n"
    refused = laptop.run(f"ssh {KNOWN} -o PubkeyAuthentication=no -v rob@bob.local true", user="pat")
    assert refused.code == 255
    assert "(publickey)" in refused.err


def test_robot_is_known_and_announces_itself(pair: Booted) -> None:
    seen = pair.laptop.wait_for(f"{UR} robots | grep {pair.robot.address}", user="pat", deadline=60.0)
    assert "bob" in seen.out
    assert "magni" in seen.out


def test_set_up_finishes_by_key_and_the_name_stays(pair: Booted) -> None:
    laptop, robot = pair.laptop, pair.robot
    line = f"{UR} robot setup rob@bob.local --name bob --base magni --no-programs --passwords-from 0"
    done = laptop.run(line, user="pat", stdin="\n\n", timeout=400).check()
    assert "ready after" in done.out
    assert "bob: robot file" not in done.out  # it was there already
    reboot(robot)
    laptop.wait_for(f"{UR} shell bob cat /etc/hostname", user="pat", deadline=60.0)
    again = laptop.run(line, user="pat", stdin="\n\n", timeout=400).check()
    assert "nothing to do" in again.out


def test_robot_that_has_booted_takes_another_seed(pair: Booted) -> None:
    laptop, robot = pair.laptop, pair.robot
    again = laptop.run(command("bob"), user="pat", stdin="\nwifi-secret\n").check()
    assert "nothing to do" in again.out
    assert "--new-host-key" not in again.out
    new = laptop.run(command("eve", "kim"), user="pat", stdin="robot-secret\nwifi-secret\n").check()
    assert "--new-host-key" not in new.out
    transfer(laptop, robot)
    for _ in range(2):  # and keeps it
        reboot(robot)
        assert robot.run("cat /etc/hostname /proc/sys/kernel/hostname").out == "eve\neve\n"
    laptop.wait_for("getent ahostsv4 eve.local", deadline=60.0)
    # A user with a password logs in by key, too, and sudo asks for the password.
    login = f"ssh {KNOWN} kim@eve.local"
    assert laptop.run(f"{login} sudo -n true", user="pat").code != 0
    for password, good in (("another", False), ("robot-secret", True)):
        done = laptop.run(f"{login} sudo -k -S true", user="pat", stdin=f"{password}\n")
        assert (done.code == 0) is good, done
