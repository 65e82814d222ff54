"""Logins in both directions, and of each computer to itself, as roslaunch needs them."""

from collections.abc import Iterator

from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import PairRule, Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.ssh.host_key import PATTERN
from ur.robot.ssh.shell import quote

_ALLOW = ">>~/.ssh/authorized_keys; chmod 600 ~/.ssh/authorized_keys"
# Any other output of the remote computer does not become a login.
_ONE_KEY = f"| LC_ALL=C grep -m 1 -xE '{PATTERN}( [!-~]{{1,100}})?'"
NEW_KEY = "[ -e ~/.ssh/id_ed25519 ] || { mkdir -p -m 700 ~/.ssh; ssh-keygen -q -t ed25519 -N '' -f ~/.ssh/id_ed25519; }"
XFORWARD = (
    "printf 'X11Forwarding yes\\nX11UseLocalhost yes\\n' >/etc/ssh/sshd_config.d/60-ubiquity.conf; systemctl reload ssh"
)


def check_rights(where: Where, side: Side) -> Iterator[Finding]:
    """Check the file permissions that ssh requires."""
    loose = find_loose(side)
    if loose:
        paths = ", ".join("~" if path == "." else f"~/{path}" for path in loose)
        present = [path for path in (".", ".ssh", ".ssh/authorized_keys") if path in side.modes]
        line = "cd; chmod go-w " + " ".join(present)
        if ".ssh/id_ed25519" in side.modes:
            line += "; chmod 600 .ssh/id_ed25519"
        yield Finding(
            "loose-rights",
            f"{side.name}: others may write or read {paths}, so ssh refuses keys",
            commands=(FixCommand(where, line, safe=True),),
        )


def find_loose(side: Side) -> list[str]:
    """Return the files whose permissions are too wide for ssh."""
    return [path for path, mode in side.modes.items() if mode & (0o077 if path.endswith("id_ed25519") else 0o022)]


def check_server(where: Where, side: Side) -> Iterator[Finding]:
    """Check the ssh server, to which roslaunch on the other computer logs in."""
    states = {side.active.get("ssh.service"), side.active.get("ssh.socket")}
    if side.active and "active" not in states:
        installed = not side.packages or "openssh-server" in side.packages
        line = "systemctl enable --now ssh" if installed else "apt-get install -y openssh-server"
        yield Finding(
            "no-ssh-server",
            f"{side.name} runs no ssh server, so nothing there can be started from the other computer",
            commands=(FixCommand(where, line, root=True, safe=installed),),
        )


def check_own_login(where: Where, side: Side) -> Iterator[Finding]:
    """Check a computer's login to itself by its full name, as roslaunch does for nodes with a machine of that name."""
    if not side.own_login or find_loose(side) or side.active.get("avahi-daemon.service") != "active":
        return
    full = f"{side.name}.local"
    allow = f"{NEW_KEY}; cat ~/.ssh/id_ed25519.pub {_ALLOW}"
    commands = [FixCommand(where, allow, safe=True)] if not _is_about_host_key(side.own_login) else []
    if side.host_key:
        commands.append(FixCommand(where, know_host(side.name, side.host_key), safe=True))
    yield Finding(
        "no-login-to-itself",
        f"{side.name} cannot log in to itself as {full}: {side.own_login}",
        commands=tuple(commands),
    )


def check_keys(pair: ComputerPair) -> Iterator[Finding]:
    """Check that each computer accepts the other one's key."""
    local, remote = pair.local, pair.remote
    if find_loose(remote) or find_loose(local):
        return  # already reported, and ssh would refuse the keys anyway
    if pair.key_refused:
        add = f"mkdir -p -m 700 ~/.ssh; echo {quote(local.public_key)} {_ALLOW}"
        yield Finding(
            "key-refused",
            f"{remote.name} does not take the key of this computer",
            "" if local.public_key else "this computer has no key (~/.ssh/id_ed25519); then --fix takes it there",
            (FixCommand("remote", add, safe=True),) if local.public_key else (FixCommand("local", NEW_KEY, safe=True),),
        )
    if (
        not pair.way_back
        or not pair.robot_login
        or pair.remote.only_ros2  # no part of ROS 2 logs in
        or not remote.resolves
        or "active" not in (local.active.get("ssh.service"), local.active.get("ssh.socket"))
    ):
        return
    stale = _is_about_host_key(pair.way_back)
    commands: tuple[FixCommand, ...]
    if stale:
        commands = (FixCommand("remote", know_host(local.name, local.host_key), safe=True),) if local.host_key else ()
    else:
        commands = (
            FixCommand("remote", NEW_KEY, safe=True),
            FixCommand(
                "local", f"ssh -- {quote(pair.login)} cat .ssh/id_ed25519.pub {_ONE_KEY} {_ALLOW}", safe=pair.known
            ),
        )
    yield Finding(
        "unknown-host-key-there" if stale else "no-login-there",
        f"{remote.name} cannot log in to {local.name}: {pair.way_back}",
        commands=commands,
    )


def know_host(name: str, host_key: str, host: str = "") -> str:
    """Return the shell command that registers this host key of a computer for the user, in place of any other.

    `host` is the full name or address if that is not NAME.local.
    """
    full = host or f"{name}.local"
    entry = quote(f"{full},{name} {host_key}" if name != full else f"{full} {host_key}")
    return f"ssh-keygen -R {quote(full)} >/dev/null 2>&1; mkdir -p -m 700 ~/.ssh; echo {entry} >>~/.ssh/known_hosts"


def check_x11(where: Where, side: Side) -> Iterator[Finding]:
    """Check that windows of programs on the robot open on this computer (X11 forwarding)."""
    if where == "remote" and side.x11 is False:
        yield Finding(
            "x11-off",
            f"{side.name}: its ssh server forwards no windows (X11Forwarding), so 'ur shell -X' cannot show any",
            commands=(FixCommand(where, XFORWARD, root=True, safe=True),),
        )


def _is_about_host_key(reported: str) -> bool:
    return "host key" in reported.lower() or "IDENTIFICATION" in reported


RULES: tuple[Rule, ...] = (
    SideRule({"no-ssh-server": "nothing can be started there from the other computer"}, check_server),
    SideRule({"loose-rights": "others may write the files of ssh, which therefore refuses keys"}, check_rights),
    PairRule(
        {
            "key-refused": "the robot does not take this computer's key",
            "no-login-there": "this computer does not take the robot's key",
            "unknown-host-key-there": "the robot has no host key of this computer, or an old one",
        },
        check_keys,
    ),
    SideRule(
        {"no-login-to-itself": "a computer cannot log in to itself, as roslaunch does"}, check_own_login, ros1=True
    ),
    SideRule({"x11-off": "the robot's ssh server shows no windows here"}, check_x11),
)
