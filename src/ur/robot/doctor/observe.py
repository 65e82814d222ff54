"""Inspection of one of two computers: one script, and the parser of its output. Both are pure."""

import re
from collections.abc import Iterable, Mapping

from ur.robot.doctor.messages import MESSAGES_SCRIPT, parse_messages
from ur.robot.doctor.side import Disk, FailedUnit, Setting, Side
from ur.robot.doctor.wifi import WIFI_SCRIPT, parse_wifi
from ur.robot.ssh.host_key import parse_public_key
from ur.robot.ssh.shell import quote
from ur.source.foreign.numbers import parse_decimal, parse_integer
from ur.system.releases import parse_os_release

_AVAHI = "org.freedesktop.Avahi"
_MARK = "\x1e"
UNITS = ("ssh.service", "ssh.socket", "avahi-daemon.service", "chrony.service", "systemd-timesyncd.service")
SSH_PATHS = (".", ".ssh", ".ssh/authorized_keys", ".ssh/id_ed25519")
PLACES = ("/", "/tmp", "/var", "/var/log", "/var/cache/apt")  # noqa: S108 - looked at, nothing is written there
LARGE = ("~/.ros/log", "~/.cache", "/var/log/journal", "/var/cache/apt")
SHELL_FILES = (
    *(f"~/{name}" for name in (".ros_setup", ".bashrc", ".bash_aliases", ".profile", ".bash_profile", ".bash_login")),
    *(f"~/{name}" for name in (".zshenv", ".zprofile", ".zshrc")),
    *("/etc/environment", "/etc/profile", "/etc/bash.bashrc"),
)
VARIABLES = ("ROS_MASTER_URI", "ROS_HOSTNAME", "ROS_IP")
STRICT = "ssh -T -o BatchMode=yes -o StrictHostKeyChecking=yes -o ConnectTimeout=5 -o LogLevel=ERROR --"
HEADERS = 28  # bytes of IP and ICMP
# Groups of shells, and the script that prints their environment; each way to start a shell is tested.
_PRINT_VARIABLES = 'for v in ROS_MASTER_URI ROS_HOSTNAME ROS_IP; do eval "w=\\${$v-}"; echo "$v=$w"; done'
_SETTING = rf"^[[:space:]]*(export[[:space:]]+)?({'|'.join(VARIABLES)})="
_FIREWALL = """\
if grep -qs '^ENABLED=yes' /etc/ufw/ufw.conf; then echo ufw
elif systemctl is-active --quiet firewalld; then echo firewalld
elif command -v nft >/dev/null; then echo nft; elif command -v iptables >/dev/null; then echo iptables; fi"""
# The scope of a login that ended too early fails as well, which is harmless. A boot service that ends is restarted
# again and again, and never counts as failed.
_FAILING = """\
systemctl --failed --type=service,mount --plain --no-legend 2>/dev/null | awk '$2 == "loaded" { print $1, 0 }'
systemctl list-units --all --plain --no-legend 'ubiquity-*.service' 2>/dev/null | cut -d' ' -f1 | while read -r u; do
s=$(systemctl show -p SubState --value "$u"); n=$(systemctl show -p NRestarts --value "$u"); n=${n:-0}
t=$(systemctl show -p ActiveEnterTimestampMonotonic --value "$u")
t=$(($(cut -d. -f1 /proc/uptime) - ${t:-0} / 1000000))
case $s in auto-restart*) echo "$u $n";; start-pre) [ "$n" = 0 ] || echo "$u $n";;
running) [ "$n" -lt 3 ] || [ "$t" -gt 30 ] || echo "$u $n";; esac; done"""


def observe_script(other: str, more: Mapping[str, str] | None = None) -> str:
    """Return the script that inspects a computer, as the user, and its view of the `other` one.

    `other` is that computer's full name, '' for none. `more` are scripts of rules, by name; their outputs are in
    `Side.observed`.
    """
    parts = [
        "mark() { printf '\\036%s\\n' \"$1\"; }; export LC_ALL=C; PATH=$PATH:/usr/sbin:/sbin; cd",
        "mark name; cat /proc/sys/kernel/hostname; id -un",
        "mark addresses; ip -brief -4 address show scope global 2>/dev/null",
        f"mark ros; {_PRINT_VARIABLES}",
        f'mark shell; timeout 10 "${{SHELL:-sh}}" -ic {quote(_PRINT_VARIABLES)} 2>/dev/null </dev/null',
        f'mark settings; for f in {" ".join(SHELL_FILES)}; do [ ! -r "$f" ] || grep -HoE {quote(_SETTING)} "$f"; done',
        "mark ros_setup; [ ! -r ~/.ros_setup ] || { cat ~/.ros_setup; echo end; }",
        f'mark modes; for p in {quote(*SSH_PATHS)}; do [ ! -e "$p" ] || stat -L -c "%a $p" "$p"; done',
        f'mark own; {STRICT} "$(cut -d. -f1 /proc/sys/kernel/hostname).local" true 2>&1 </dev/null || echo failed',
        "mark host_key; cut -d' ' -f1,2 /etc/ssh/ssh_host_ed25519_key.pub 2>/dev/null",
        "mark public_key; cat .ssh/id_ed25519.pub 2>/dev/null",
        "mark x11; cat /etc/ssh/sshd_config.d/*.conf /etc/ssh/sshd_config 2>/dev/null | grep -iE '^ *x11forwarding'",
        f'mark active; for u in {quote(*UNITS)}; do echo "$u $(systemctl is-active $u 2>/dev/null)"; done',
        f"mark failing; {_FAILING}",
        f"mark announced; timeout 5 busctl call {_AVAHI} / {_AVAHI}.Server GetHostName 2>/dev/null",
        f'mark disk; df -Pm {quote(*PLACES)} "$HOME" 2>/dev/null',
        f'mark large; df -Pm {quote(*PLACES)} "$HOME" 2>/dev/null | grep -qE " (9[0-9]|100)% " && '
        f'for f in {" ".join(LARGE)}; do timeout 5 du -sxm "$f" 2>/dev/null; done',
        "mark memory; grep MemAvailable /proc/meminfo",
        f"mark firewall; {_FIREWALL}",
        'mark system; . /etc/os-release; echo "$PRETTY_NAME"; uname -m',
        "mark release; cat /etc/os-release",
        "mark ur; cat /etc/avahi/services/ubiquity.service 2>/dev/null",
        "mark packages; dpkg-query -W -f='${db:Status-Status} ${Package} ${Version}\\n' 2>/dev/null",
        "mark built; [ ! -e catkin_ws/devel ] || echo yes",
        "mark workspace; find -L catkin_ws/src -maxdepth 4 -name package.xml 2>/dev/null",
        f"mark messages; {MESSAGES_SCRIPT}",
    ]
    parts += [f"mark {name}; {script}" for name, script in (more or {}).items()]
    if other:
        parts.append(_other_script(quote(other)))
    # After the pings: the rate is that of the latest packets.
    return "\n".join([*parts, f"mark wifi\n{WIFI_SCRIPT}", "mark end"])


def _other_script(name: str) -> str:
    return f"""\
r=$(timeout 8 getent ahostsv4 {name}); a=$(echo "$r" | head -n 1 | cut -d' ' -f1); a=${{a:-x}}
d=$(ip -4 route get "$a" 2>/dev/null | grep -o 'dev [^ ]*' | cut -d' ' -f2)
m=$(cat "/sys/class/net/$d/mtu" 2>/dev/null)
mark resolves; echo "$r"
mark device; echo "$d $m"
mark ping; ping -q -n -c 5 -i 0.2 -W 1 "$a" 2>/dev/null
mark frame; ping -q -n -c 2 -i 0.2 -W 1 -M do -s $((${{m:-1500}} - {HEADERS})) "$a" 2>&1"""


def parse_side(output: str, names: Iterable[str] = ()) -> Side:
    """Parse the output of the script, with the scripts of rules by `names`; invalid values become unknown."""
    # Repeats in the patterns are bounded, or a long line would take quadratic time.
    output = output.replace("\0", "")  # as in a shell: no argument contains a null byte
    parts = {name: text for name, _, text in (part.partition("\n") for part in output.split(_MARK)[1:])}
    name, user = [*parts.get("name", "").split(), "", ""][:2]
    ping = parts.get("ping", "")
    loss = re.search(r"([\d.]{1,20})% packet loss", ping)
    times = re.search(r"= [\d.]{1,20}/([\d.]{1,20})/", ping)
    lost = _scale(re.search(r"([\d.]{1,20})% packet loss", parts.get("frame", "")), 0.01)
    memory = re.search(r"(\d{1,15}) kB", parts.get("memory", ""))
    announced = re.search(r'"(.*)"', parts.get("announced", ""))
    device, mtu = [*parts.get("device", "").split(), "", ""][:2]
    x11 = re.search(r"(?i)x11forwarding\s+(\w+)", parts.get("x11", ""))  # sshd takes the first
    own = parts.get("own", "").strip().splitlines()
    return Side(
        name=name,
        user=user,
        addresses=tuple(re.findall(r"\b(\d{1,3}\.\d{1,3}\.\d{1,3}\.\d{1,3})/\d", parts.get("addresses", ""))),
        resolves=frozenset(line.split()[0] for line in parts.get("resolves", "").splitlines() if line.strip()),
        ros=_variables(parts.get("ros", "")),
        shell=_variables(parts.get("shell", "")),
        settings=tuple(_settings(parts.get("settings", "").splitlines())),
        ros_setup=parts["ros_setup"].rpartition("end\n")[0] if parts.get("ros_setup") else None,
        modes={
            path: number
            for mode, _, path in (row.partition(" ") for row in parts.get("modes", "").splitlines())
            if (number := parse_integer(mode, 8)) is not None
        },
        own_login=[*own[:-1], "ssh printed nothing"][0] if own[-1:] == ["failed"] else "",
        host_key=_read_key(parts.get("host_key", "")),
        public_key=_read_key(parts.get("public_key", "")),
        x11=x11[1].lower() == "yes" if x11 else False if "x11" in parts else None,
        active={unit: state for unit, _, state in (row.partition(" ") for row in parts.get("active", "").splitlines())},
        failing=tuple(_failing(parts.get("failing", "").splitlines())),
        announced=announced[1] if announced else "",
        disks=tuple(_disks(parts.get("disk", "").splitlines())),
        large={
            path: megabytes
            for size, _, path in (row.partition("\t") for row in parts.get("large", "").splitlines())
            if (megabytes := parse_decimal(size)) is not None
        },
        memory_free=_scale(memory, 1 / 1024),
        loss=_scale(loss, 0.01),
        latency=_scale(times, 0.001),
        device=device,
        mtu=parse_integer(mtu),
        full_frames=None if lost is None else lost < 1,
        firewall=parts.get("firewall", "").strip(),
        packages=_packages(line.split() for line in parts.get("packages", "").splitlines()),
        messages=parse_messages(parts.get("messages", "")),
        built=bool(parts.get("built", "").strip()),
        workspace=frozenset(re.findall(r"([^/\n]{1,255})/package\.xml", parts.get("workspace", ""))),
        ur=ur[1] if (ur := re.search(r"version=([^<]+)", parts.get("ur", ""))) else "",
        system=" ".join(parts.get("system", "").split("\n")).strip(),
        release=parse_os_release(parts["release"]) if parts.get("release", "").strip() else None,
        wifi=parse_wifi(parts.get("wifi", "")),
        observed={name: parts[name] for name in names if name in parts},
    )


def _packages(rows: Iterable[list[str]]) -> dict[str, str]:
    return {row[1]: row[2] for row in rows if len(row) == 3 and row[0] == "installed"}


def _scale(found: re.Match[str] | None, factor: float) -> float | None:
    number = parse_decimal(found[1]) if found else None
    return None if number is None else number * factor


def _read_key(text: str) -> str:
    """Return a public key as reported, '' if it is invalid: it is written to a file that decides who may log in."""
    try:
        return str(parse_public_key(text.strip("\n")))
    except ValueError:
        return ""


def _variables(text: str) -> Mapping[str, str]:
    pairs = (line.partition("=") for line in text.splitlines())
    return {key: value for key, _, value in pairs if value and key in VARIABLES}


def _settings(lines: Iterable[str]) -> Iterable[Setting]:
    for line in lines:
        file, _, text = line.partition(":")
        found = re.search(r"(ROS_\w{1,60})=", text)
        if found:
            yield Setting(file, found[1])


def _failing(lines: Iterable[str]) -> Iterable[FailedUnit]:
    for line in lines:
        name, _, restarts = line.partition(" ")
        count = parse_integer(restarts)
        if name and count is not None and count >= 0:
            yield FailedUnit(name, count)


def _disks(lines: Iterable[str]) -> Iterable[Disk]:
    found: dict[str, Disk] = {}
    for line in lines:
        row = line.split(None, 5)
        size, free = (parse_decimal(row[1]), parse_decimal(row[3])) if len(row) == 6 else (None, None)
        if size is not None and free is not None:
            found[row[5]] = Disk(row[5], free, 1 - free / size if size else 0.0)
    return found.values()
