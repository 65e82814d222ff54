"""Diagnosis of a failed login: name, ping, port 22, host key, login; the first step that fails, and its fix.

`inspect_route` uses the network; the other functions are pure.
"""

import socket
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from ur.robot.discovery.record import RobotRecord
from ur.robot.discovery.seen import SeenRobot, describe_age
from ur.robot.doctor.findings import Finding, FixCommand
from ur.robot.doctor.rules.login import know_host
from ur.robot.ssh.address import Address
from ur.robot.ssh.host_key import HostKey, fetch_host_key
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError

PORT_SECONDS = 3.0
_NO_COMMAND = 127  # exit code of a shell
_PINGED = {True: "", False: "none", None: "not tried: ping is not installed"}
Port = Literal["open", "refused", "silent", ""]


@dataclass(frozen=True, slots=True)
class RouteState:
    """The result of each step on the route to a robot.

    `resolves`: the addresses of the name; `ping`: it answers (None: ping is not installed); `port`: port 22 is open.
    `rule` and `reason` tell why the login failed; `host_key` is the key that the robot offers now, if relevant; `twin`:
    addresses of a computer that zeroconf named NAME-2.
    """

    resolves: tuple[str, ...]
    ping: bool | None = False
    port: Port = ""
    rule: str = ""
    reason: str = ""
    host_key: HostKey | None = None
    twin: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class RouteStep:
    """One step of a route: `good` is None for steps after a failed one."""

    title: str
    good: bool | None
    seen: str = ""


def inspect_route(local: Shell, address: Address, rule: str, reason: str) -> RouteState:
    """Test each step, after a login failed with a diagnostic's `rule` and `reason`."""
    host = quote(address.host)
    found = local.run(f"timeout 8 getent ahostsv4 {host}").out.split("\n")
    resolves = tuple(dict.fromkeys(line.split()[0] for line in found if line.strip()))
    if not resolves:
        return RouteState((), rule=rule, reason=reason)
    code = local.run(f"ping -q -n -c 2 -i 0.2 -W 1 {quote(resolves[0])}").code
    ping = None if code == _NO_COMMAND else code == 0
    port = _probe_port(resolves[0])
    host_key = _fetch(address) if rule in ("changed-host-key", "unknown-host-key") else None
    twin = local.run(f"timeout 2 getent ahostsv4 {quote(_short(address) + '-2.local')}").out.split()[:1]
    return RouteState(resolves, ping, port, rule, reason, host_key, tuple(twin))


def _fetch(address: Address) -> HostKey | None:
    with suppress(UserError):
        return fetch_host_key(address)
    return None


def _probe_port(address: str) -> Port:
    try:
        socket.create_connection((address, 22), timeout=PORT_SECONDS).close()
    except ConnectionRefusedError:
        return "refused"
    except OSError:
        return "silent"
    return "open"


def list_steps(address: Address, route: RouteState) -> list[RouteStep]:
    """List the steps from the name to the login; the first one that failed is the cause."""
    open_port = route.port == "open"
    wrong_key = route.rule in ("changed-host-key", "unknown-host-key")
    steps = [
        RouteStep(f"name {address.host}", bool(route.resolves), ", ".join(route.resolves) or "not resolved"),
        # Some networks block ping: a computer that answers on its port exists nevertheless.
        RouteStep("answer to ping", route.ping is not False or open_port, _PINGED[route.ping]),
        RouteStep("port 22", open_port, {"silent": "no answer"}.get(route.port, route.port)),
        RouteStep(
            "host key",
            not wrong_key,
            {"changed-host-key": "another one than is known"}.get(route.rule, "not known") if wrong_key else "",
        ),
        RouteStep(f"login as {address.user}", False, route.reason),
    ]
    end = next(index for index, step in enumerate(steps) if not step.good)
    return [step if index <= end else RouteStep(step.title, None) for index, step in enumerate(steps)]


def explain_route(
    address: Address, route: RouteState, seen: SeenRobot | None, record: RobotRecord | None, now: float
) -> Finding:
    """Explain the step that fails, with a fix."""
    host, name = address.host, _short(address)
    if not route.resolves:
        last = f"; it was last seen at {seen.address}, {describe_age(now - seen.time)}" if seen else ""
        return Finding(
            "robot-not-found",
            f"the name {host} cannot be resolved{last}",
            "is it on, and in the same network? was it renamed? 'ur robots' lists the robots that answer; "
            "at the robot itself: systemctl status avahi-daemon",
        )
    where = ", ".join(route.resolves)
    if route.port == "refused":
        line = "apt-get install -y openssh-server; systemctl enable --now ssh"
        return Finding(
            "no-ssh-server",
            f"{host} ({where}) answers, but runs no ssh server",
            "at the robot itself:",
            (FixCommand("remote", line, root=True),),
        )
    if route.port != "open":
        if route.ping:
            line = "ufw allow ssh"
            return Finding(
                "closed-ssh-port",
                f"{host} ({where}) is there, and a firewall keeps port 22 closed",
                "at the robot itself:",
                (FixCommand("remote", line, root=True),),
            )
        return Finding(
            "robot-silent",
            f"nothing answers at {where}, which is what {host} means",
            "is it on, and in the same network? Networks for guests keep their devices apart",
        )
    return _explain_login(address, route, record, name)


def _explain_login(address: Address, route: RouteState, record: RobotRecord | None, name: str) -> Finding:
    host = address.host
    again = f"ur robot setup {quote(str(address))}" + (
        f" --name {quote(record.name)} --base {quote(record.base)}" if record else ""
    )
    shown = f"; its key now: {route.host_key.fingerprint}" if route.host_key else ""
    # The line has the key whose fingerprint is displayed: a later answer has to come from the same computer.
    renew = (FixCommand("local", know_host(name, route.host_key.key, host)),) if route.host_key else ()
    compare = "compare with the robot's own (ssh-keygen -lf /etc/ssh/ssh_host_ed25519_key.pub)"
    if route.rule == "changed-host-key":
        twin = f"; another computer has its name, too, and is {name}-2.local ({route.twin[0]})" if route.twin else ""
        return Finding(
            "changed-host-key",
            f"{host} shows another host key than the one that is known here{shown}{twin}",
            f"{compare}, and if it is that one, renew what is known here. Flashed again: {again} --new-host-key",
            renew,
        )
    if route.rule == "unknown-host-key":
        return Finding(
            "unknown-host-key",
            f"the host key of {host} is not known here{shown}",
            f"set it up: {again}; or, where that was done from another computer, {compare} and know it from now on:",
            renew,
        )
    if route.rule == "refused":
        return Finding(
            "key-refused",
            f"{host} refuses {address.user}: it does not take this computer's key, and no password was given",
            "is that the user there? Then, once, with the password of that user:",
            (FixCommand("local", f"ssh-copy-id -i ~/.ssh/id_ed25519.pub {quote(str(address))}"),),
        )
    return Finding(
        "no-login", f"{address}: {route.reason}", "run this again; at the robot itself: journalctl -u ssh -n 20"
    )


def _short(address: Address) -> str:
    return address.host.removesuffix(".local")
