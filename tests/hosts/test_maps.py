"""`ur maps copy` between two computers: both directions, and a network that is cut on the way."""

import os
import signal
from collections.abc import Iterator

import pytest
from tests.hosts.bench import UR, Bench, Machine, boot, wait_until

ROBOT = "ros@10.77.0.11"
MAPS = ".local/share/ubiquity_launches/maps"
# Random cells, so that the map stays large when it is packed.
DRAW = """\
import sys, numpy
values = numpy.random.default_rng(0).integers(0, 255, (1500, 2000)).astype(numpy.uint8)
open("large.pgm", "wb").write(b"P5 2000 1500 255\\n" + values.tobytes())
open("large.yaml", "w").write(
    "image: large.pgm\\nresolution: 0.05\\norigin: [0, 0, 0]\\nnegate: 0\\noccupied_thresh: 0.65\\nfree_thresh: 0.2\\n"
    "mode: raw\\n"
)
"""
LOGIN = """\
set -e
mkdir -p -m 700 .ssh
[ -f .ssh/id_ed25519 ] || ssh-keygen -q -t ed25519 -N '' -f .ssh/id_ed25519
"""


@pytest.fixture(scope="module")
def pair() -> Iterator[Bench]:
    """A laptop with a large map, whose user may log in on the robot."""
    with boot(("laptop", "robot")) as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        laptop.run(LOGIN, user="pat").check()
        key = laptop.run("cat .ssh/id_ed25519.pub", user="pat").check().out
        robot.run("mkdir -p -m 700 .ssh && cat >>.ssh/authorized_keys", user="ros", stdin=key).check()
        host_key = robot.run("cat /etc/ssh/ssh_host_ed25519_key.pub").check().out
        laptop.run("cat >>.ssh/known_hosts", user="pat", stdin=f"10.77.0.11 {host_key}").check()
        laptop.wait_for(f"ssh -o BatchMode=yes {ROBOT} true", user="pat", deadline=60)
        laptop.run(f"{UR.split()[0]} -", user="pat", stdin=DRAW).check()
        laptop.run(f"{UR} maps import large.yaml", user="pat", timeout=120).check()
        yield bench


def copying(robot: Machine) -> list[int]:
    """The processes on the robot that send or receive a map, by their numbers here."""
    return [process for process, line in robot.processes() if line.split(" ")[0] == "base64"]


def test_map_goes_there_and_back(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.run(f"{UR} maps copy large --to {ROBOT} --as there", user="pat", timeout=500).check()
    assert laptop.run(f"{UR} maps --robot {ROBOT}", user="pat").check().out == "there\n"
    laptop.run(f"{UR} maps copy there --from {ROBOT} --as back", user="pat", timeout=500).check()
    laptop.run(f"diff -r -x .lock {MAPS}/large {MAPS}/back", user="pat").check()
    assert robot.run(f"ls -A {MAPS}; ls -d /tmp/tmp.* 2>/dev/null || true", user="ros").check().out.split() == ["there"]
    again = laptop.run(f"{UR} maps copy large --to {ROBOT} --as there", user="pat", timeout=500)
    assert again.code == 2
    assert "already, expected a new name" in again.err


def test_network_that_is_cut_leaves_no_map(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.wait_for(f"ssh -o BatchMode=yes {ROBOT} true", user="pat", deadline=60)
    robot.run(f"[ -d {MAPS}/there ]", user="ros").check()
    interface = "tc qdisc {} dev host0 root tbf rate 2mbit burst 200kb latency 400ms"
    laptop.run(interface.format("add")).check()
    robot.run(interface.format("add")).check()
    process = laptop.spawn(f"exec {UR} maps copy large --to {ROBOT} --as cut", user="pat")
    try:
        wait_until(lambda: bool(copying(robot)) or process.poll() is not None, "the map is on its way", 100.0)
        assert process.poll() is None, process.communicate()[0]
        robot.cut()
        said, _ = process.communicate(timeout=200)
    finally:
        process.kill()
        robot.restore()
        for machine in (laptop, robot):
            machine.run("tc qdisc del dev host0 root")
    assert process.returncode == 2, said
    assert "error: " in said
    assert "Traceback" not in said
    for machine, user in ((laptop, "pat"), (robot, "ros")):
        assert machine.run(f"ls {MAPS}", user=user).check().out.split().count("cut") == 0
    assert laptop.run(f"ls -A {MAPS}", user="pat").check().out.count(".new-") == 0
    for number in copying(robot):  # as the time limit there would, minutes later
        os.kill(number, signal.SIGTERM)
    robot.wait_for(f"! ls -A {MAPS} | grep -q .new-", user="ros", deadline=30)
