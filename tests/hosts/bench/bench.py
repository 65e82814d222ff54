"""A laptop and robots on a network of their own: booted together, removed together."""

import secrets
import signal
import subprocess
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType, MappingProxyType

from tests.hosts.bench.groups import make_groups
from tests.hosts.bench.ledger import Ledger, find_process, remove_all, remove_stale, this_process
from tests.hosts.bench.machine import Machine
from tests.hosts.bench.root import cache_folder, make_root

REPOSITORY = Path(__file__).resolve().parents[3]
FOLDERS = Path("/var/tmp")
NETWORK = """\
[Match]
Name=host0
[Network]
Address={address}/24
LinkLocalAddressing=ipv6
MulticastDNS=no
DHCP=no
"""
# Started without systemd, systemd-nspawn leaves rebooting to its caller (exit code 133); and it empties its folder in
# /run, which it refuses where /run is on a disk. Right after a reboot it may fail (1): the kernel still has the network
# interface of the computer that went. The first word: the folders of the control groups that it is to run in.
KEEP_RUNNING = """
groups=$1 && shift
enter='for group in $0; do echo $$ >"$group/cgroup.procs" || exit 2; done; exec "$@"'
mkdir -p /run/systemd/nspawn && mount -t tmpfs tmpfs /run/systemd/nspawn || exit
failures=0 reboots=0
while sh -c "$enter" "$groups" "$@"; code=$?; do
  echo "systemd-nspawn has ended with exit code $code" >&2
  case $code in
    133) failures=0 reboots=$((reboots + 1)) ;;
    1) failures=$((failures + 1)); [ $reboots -gt 0 ] && [ $failures -le 50 ] || break; sleep 0.1 ;;
    *) break ;;
  esac
done
exit $code
"""


@dataclass(frozen=True, slots=True)
class Bench:
    """Running computers by name."""

    ledger: Ledger
    machines: Mapping[str, Machine]
    root: Path

    def __getitem__(self, name: str) -> Machine:
        return self.machines[name]

    def boot_stranger(self, name: str, number: int = 90) -> Machine:
        """Boot one more computer on this network, which may have any host name; it goes with the bench."""
        machine = _start(self.ledger, self.root, name, f"10.77.0.{number}")
        machine.wait_booted(180.0)
        return machine


@contextmanager
def boot(
    names: Sequence[str] = ("laptop", "robot"),
    *,
    with_repository: Sequence[str] = ("laptop",),
    programs: bool = False,
    suites: Mapping[str, str] = MappingProxyType({}),
) -> Iterator[Bench]:
    """Boot computers with these host names and wait for their ssh servers; remove everything at the end.

    Those `with_repository` have this repository where it is here, to read only, and its environment. With `programs`
    all of them have the Debian packages that robot programs need, which else the set-up installs. `suites` are the
    codenames of releases of this computer's distribution, for those that are to have another one. What an earlier
    bench that was killed left behind is removed first. SIGTERM and SIGHUP end this one as Ctrl-C does (in the main
    thread).
    """
    remove_stale()
    root = make_root(cache_folder(), programs=programs)
    roots = {name: make_root(cache_folder(), programs=programs, suite=suite) for name, suite in suites.items()}
    identity = secrets.token_hex(3)
    ledger = Ledger(identity, this_process(), str(FOLDERS / f"ur-hosts.{identity}"), bridge=f"urh{identity}")
    ledger.save()
    with _ended_by_signals():
        try:
            _make_bridge(ledger.bridge)
            machines = {
                name: _start(
                    ledger, roots.get(name, root), name, f"10.77.0.{10 + index}", repository=name in with_repository
                )
                for index, name in enumerate(names)
            }
            for machine in machines.values():
                machine.wait_booted()
            yield Bench(ledger, machines, root)
        finally:
            remove_all(ledger)


def _make_bridge(name: str) -> None:
    for words in (
        ["link", "add", name, "type", "bridge", "mcast_snooping", "0"],
        ["link", "set", name, "addrgenmode", "none"],
        ["link", "set", name, "up"],
    ):
        subprocess.run(["ip", *words], check=True, capture_output=True)


def _start(ledger: Ledger, shared: Path, name: str, address: str, *, repository: bool = False) -> Machine:
    folder = Path(ledger.folder, name)
    root = folder / "root"
    for part in ("upper", "work", "root"):
        (folder / part).mkdir(parents=True)
    folder.parent.chmod(0o700)
    ledger.mounts.append(str(root))
    ledger.save()
    layers = f"lowerdir={shared},upperdir={folder / 'upper'},workdir={folder / 'work'}"
    subprocess.run(["mount", "-t", "overlay", "overlay", "-o", layers, str(root)], check=True, capture_output=True)
    (root / "etc/hostname").write_text(name + "\n")
    (root / "etc/hosts").write_text(f"127.0.0.1\tlocalhost\n127.0.1.1\t{name}\n::1\tlocalhost ip6-localhost\n")
    (root / "etc/systemd/network").mkdir(exist_ok=True)
    (root / "etc/systemd/network/10-host0.network").write_text(NETWORK.format(address=address))
    machine = f"ur-{ledger.name}-{name}"
    groups = make_groups(machine)
    ledger.groups.extend(groups)
    ledger.save()
    command = [
        *("unshare", "--mount", "--propagation", "private", "--", "sh", "-c", KEEP_RUNNING, "sh", " ".join(groups)),
        "systemd-nspawn",
        f"--directory={root}",
        "--boot",
        f"--machine={machine}",
        "--register=no",
        "--keep-unit",
        f"--network-bridge={ledger.bridge}",
        "--link-journal=no",
        "--resolv-conf=off",
        "--timezone=off",
        "--console=pipe",
        "--quiet",
        *([f"--bind-ro={REPOSITORY}"] if repository else []),
        "systemd.show_status=0",
    ]
    console = folder / "console"
    with console.open("wb") as output:
        # A session of its own: Ctrl-C ends the tests, which then end the computers.
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, start_new_session=True
        )
    ledger.processes.append(find_process(process.pid))
    ledger.save()
    return Machine(name, address, root, ledger.bridge, console, process.pid)


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def end(number: int, _: FrameType | None) -> None:
        raise KeyboardInterrupt(signal.Signals(number).name)

    before = {number: signal.signal(number, end) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
