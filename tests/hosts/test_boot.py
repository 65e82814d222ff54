"""`ur boot`: what a robot starts by itself, after a reboot and with a network that comes late."""

from __future__ import annotations

import pytest
from tests.hosts.bench import UR, Bench
from tests.hosts.test_doctor import pair

pytestmark = pytest.mark.long
__all__ = ["pair"]
TALK = 'rostopic pub -r 5 /words std_msgs/String "data: it\'s 100% \\$HOME"'
HEAR = "timeout 10 rostopic echo -n 1 /words"


def test_program_runs_after_a_reboot_and_with_a_late_network(pair: Bench) -> None:
    laptop, robot = pair["laptop"], pair["robot"]
    laptop.run(f"{UR} use bob", user="pat").check()
    laptop.run(f"{UR} boot install --name talk {TALK}", user="pat").check()
    assert "nothing to do" in laptop.run(f"{UR} boot install --name talk {TALK}", user="pat").check().out
    said = laptop.wait_for(HEAR, user="pat")
    assert "it's 100% $HOME" in said.out

    leader = robot.leader
    robot.run("systemctl reboot")
    robot.wait_rebooted(leader)
    laptop.wait_for(HEAR, user="pat", deadline=60)
    assert laptop.run("rosparam get /ur/base_name", user="pat").check().out.strip() == "magni"  # from its robot.yaml

    # Its address comes only later: as on a WiFi that takes its time.
    robot.run("sed -i s/^Address/#Address/ /etc/systemd/network/10-host0.network").check()
    leader = robot.leader
    robot.run("systemctl reboot")
    robot.wait_rebooted(leader)
    robot.wait_for("systemctl show -p ActiveState ubiquity-master | grep -q activating")
    robot.run("sed -i s/^#Address/Address/ /etc/systemd/network/10-host0.network; networkctl reload").check()
    laptop.wait_for(HEAR, user="pat", deadline=60)

    assert "ubiquity-talk.service" in laptop.run(f"{UR} boot status", user="pat").check().out
    removed = laptop.run(f"{UR} boot remove", user="pat").check().out
    assert removed.count(": removed") == 2
    assert "nothing" in laptop.run(f"{UR} boot status", user="pat").check().out
    assert robot.run("pgrep -u ros -f roscore").code != 0
