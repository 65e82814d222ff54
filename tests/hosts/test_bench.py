"""The bench itself: computers that find each other, can be cut off, and leave nothing behind."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from tests.hosts.bench import REPOSITORY, Bench, wait_until
from tests.hosts.bench import ledger as ledgers
from tests.hosts.bench.ledger import Ledger, remove_stale
from tests.hosts.bench.root import cache_folder, make_root

OWNER = """
import pathlib, sys, time
from tests.hosts.bench import boot, ledger
ledger.LEDGERS = pathlib.Path(sys.argv[1])
with boot(["robot"]) as bench:
    print(bench.ledger.name, flush=True)
    time.sleep(600)
"""


def test_laptop_reaches_robot_by_its_zeroconf_name(bench: Bench) -> None:
    bench["laptop"].wait_for("ping -c 1 -W 1 robot.local")
    bench["robot"].wait_for("ping -c 1 -W 1 laptop.local")


def test_cut_robot_is_unreachable_until_restored(bench: Bench) -> None:
    ping = f"ping -c 1 -W 1 {bench['robot'].address}"
    bench["laptop"].run(ping).check()
    bench["robot"].cut()
    assert bench["laptop"].run(ping).code != 0
    bench["robot"].restore()
    bench["laptop"].wait_for(ping)


def test_robot_comes_back_after_a_reboot_with_what_was_written(bench: Bench) -> None:
    robot = bench["robot"]
    robot.write("/etc/written", "before\n")
    leader = robot.leader
    robot.run("systemctl reboot")
    robot.wait_rebooted(leader)
    assert robot.read("/etc/written") == "before\n"
    bench["laptop"].wait_for("ping -c 1 -W 1 robot.local")


def test_computers_reach_nothing_but_each_other(bench: Bench) -> None:
    routes = bench["laptop"].run("ip route; ip -6 route").check().out
    assert "default" not in routes
    assert (
        subprocess.run(
            ["ip", "-brief", "address", "show", bench.ledger.bridge], capture_output=True, text=True
        ).stdout.split()[2:]
        == []
    )


def test_computers_share_no_control_group(bench: Bench) -> None:
    groups = [Path(f"/proc/{bench[name].leader}/cgroup").read_text() for name in ("laptop", "robot")]
    systemd = [{line for line in text.splitlines() if line.split(":")[1] in ("", "name=systemd")} for text in groups]
    assert systemd[0]
    assert not systemd[0] & systemd[1]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_nothing_is_left_however_the_owner_ends(
    number: signal.Signals, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ledgers, "LEDGERS", tmp_path)  # else another bench that starts meanwhile removes it first
    make_root(cache_folder())
    command = [sys.executable, "-c", OWNER, str(tmp_path)]
    owner = subprocess.Popen(command, cwd=REPOSITORY, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert owner.stdout
    with owner.stdout:
        name = owner.stdout.readline().strip()
    ledger = Ledger.load(tmp_path / f"{name}.json")
    assert all(process.alive for process in ledger.processes)
    owner.send_signal(number)
    owner.wait(30)
    if number == signal.SIGKILL:
        assert name in remove_stale()
    assert not any(process.alive for process in ledger.processes)
    assert not ledger.path.exists()
    assert not Path(ledger.folder).exists()
    assert not any(Path(group).exists() for group in ledger.groups)
    assert not any(mount in Path("/proc/self/mounts").read_text() for mount in ledger.mounts)
    wait_until(lambda: not _links(ledger), f"links of {name} gone", 10)


def _links(ledger: Ledger) -> list[str]:
    return [link.name for link in Path("/sys/class/net").iterdir() if ledger.name in link.name]
