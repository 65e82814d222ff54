"""Two commands on the laptop, from a freshly flashed robot without internet to a program that runs there."""

import re
import shutil
import sys
from collections.abc import Collection, Iterator

import pytest
from tests.hosts.bench import UR, Bench, Machine, boot
from tests.hosts.bench.wheels import wheel_folder
from tests.hosts.test_robot_setup import PASSWORD, prepare
from tests.hosts.test_robot_setup_interrupted import run_until

from ur.robot.setup.robot_states import PROGRAM_PACKAGES

pytestmark = [pytest.mark.timeout(1800)]
SET_UP = f"{UR} robot setup robot.local --name bob --base magni --variant lidar --passwords-from 0 --yes"
AGAIN = SET_UP.replace("robot.local", "bob.local")
PASSWORDS = f"ros\n{PASSWORD}\n"
# An address of the laptop alone: the robot has no route to it, and cannot resolve the name.
MIRROR = "10.99.0.1"
HOST = "packages.test"
SECONDS = 900.0


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    """A laptop with package servers that only it reaches, and a freshly flashed robot whose settings name them."""
    with boot(("laptop", "robot")) as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        serve_packages(laptop)
        robot.run("rm -rf /srv/offered /var/lib/apt/lists/*").check()
        robot.write("/etc/apt/sources.list", f"deb [trusted=yes] http://{HOST}/debian ./\n")
        robot.write("/etc/pip.conf", f"[global]\nindex-url = http://{HOST}/simple\ntrusted-host = {HOST}\n")
        # The laptop's share of a program needs the same packages.
        install = "apt-get -qq update && apt-get -qq -y --no-install-recommends install"
        laptop.run(f"{install} {' '.join(PROGRAM_PACKAGES)} ros-robot-state-publisher", timeout=300).check()
        prepare(laptop)
        yield bench


def serve_packages(laptop: Machine, pythons: Collection[tuple[int, int]] = (sys.version_info[:2],)) -> None:
    """Serve the offered Debian packages, and the locked wheels for versions of Python, to the laptop itself."""
    for python in pythons:
        shutil.copytree(wheel_folder(python), laptop.root / "srv/mirror/simple", dirs_exist_ok=True)
    laptop.run("ln -s /srv/offered /srv/mirror/debian").check()
    laptop.run(f"ip address add {MIRROR}/32 dev lo && echo '{MIRROR} {HOST}' >>/etc/hosts").check()
    serve = f"python3 -m http.server 80 --bind {MIRROR} --directory /srv/mirror"
    laptop.run(f"systemd-run --unit=mirror {serve}").check()
    laptop.wait_for(f"timeout 2 bash -c 'exec 3<>/dev/tcp/{HOST}/80'")


def test_program_runs_after_two_commands_though_the_first_was_interrupted_once(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    assert robot.run(f"getent hosts {HOST}").code != 0
    assert robot.run(f"timeout 5 bash -c 'exec 3<>/dev/tcp/{MIRROR}/80'").code != 0

    def kill(number: int) -> None:
        robot.wait_for("pgrep -u ros -f 'pip install'", deadline=120)
        laptop.run(f"kill -KILL {number}")

    point = "bob: programs (this takes some minutes)"
    said, code = run_until(laptop, SET_UP, PASSWORDS, {point: kill})
    assert point in said, said
    assert code != 0

    # The first command, once more.
    done = laptop.run(SET_UP, user="pat", stdin=PASSWORDS, timeout=SECONDS).check()
    assert f"it fetches packages over this computer's connection ({HOST})" in done.out
    assert re.search(r"bob: programs, \d+ s: ", done.out)
    assert "NO" not in done.out
    table = re.sub(r"[\s│]+", " ", done.out)  # a long cell takes several lines
    assert re.search(r"ok programs ros@bob\.local ur [^ ]+ \(copy [^ ]+\) copy [0-9a-f]{7}", table), done.out
    assert "it is selected" in done.out
    left = robot.run(f"grep -rlE '127.0.0.1:|{PASSWORD}' /etc/apt /etc/pip.conf /etc/environment").out
    assert left == ""

    # The second.
    begin = f"{UR} run keyboard_navigate simulate:=true"
    done = laptop.run(begin, user="pat", stdin="g 1 0 0\nq\n", timeout=300)
    assert done.code == 0, f"{done.out}\n{done.err}"
    assert re.search(r"bob: \d+ nodes?, run m_keyboard_navigate", done.out + done.err), f"{done.out}\n{done.err}"
    robot.wait_for("! pgrep -u ros -f ur_nodes", deadline=60)


def test_second_run_finds_the_project_ready_and_fetches_nothing(pair: Bench) -> None:
    laptop = pair["laptop"]
    laptop.run("systemctl stop mirror").check()
    try:
        done = laptop.run(AGAIN, user="pat", stdin=f"{PASSWORD}\n\n", timeout=300).check()
    finally:
        serve = f"python3 -m http.server 80 --bind {MIRROR} --directory /srv/mirror"
        laptop.run(f"systemd-run --unit=mirror {serve}").check()
    assert "nothing to do: it is ready" in done.out
    assert "this computer's connection" not in done.out


def test_changed_variant_is_in_force_at_once(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    before = robot.run("systemctl show -P InvocationID ubiquity-master").check().out
    done = laptop.run(AGAIN.replace("lidar", "plain"), user="pat", stdin=f"{PASSWORD}\n\n", timeout=300).check()
    assert "ROS master: base magni; programs that run keep the former one until they are restarted" in done.out
    assert robot.run("rosparam get /ur/variant", user="ros").check().out.strip() in ("", "''")
    done = laptop.run(AGAIN, user="pat", stdin=f"{PASSWORD}\n\n", timeout=300).check()
    assert "ROS master: base magni, variant lidar;" in done.out
    assert robot.run("rosparam get /ur/variant", user="ros").check().out.strip() == "lidar"
    assert robot.run("systemctl show -P InvocationID ubiquity-master").check().out == before
