"""Discovery between the nodes of one computer: releases, domains, middlewares, and their requirements."""

from collections.abc import Callable, Iterator, Mapping
from urllib.parse import urlsplit

from ur.robot.doctor.findings import Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.ros2.seen_graph import NAMES, OLD_RELEASES, Process, domain_of, middleware_of
from ur.robot.ssh.shell import quote
from ur.source.foreign.numbers import parse_integer

HIGHEST_DOMAIN = 101  # above, ports of DDS are in the range that Linux assigns to any program
_FAST_DDS = "rmw_fastrtps"
ZENOH, ZENOH_PORT, SERVER_PORT = "rmw_zenoh_cpp", 7447, 11811
SHOWN = 4


def check_processes(where: Where, side: Side) -> Iterator[Finding]:
    """Check for processes of one computer that do not discover each other.

    On this computer, only those that systemd starts: a user may run a simulated robot in a separate domain.
    """
    running = [each for each in side.ros2.processes if each.readable and (where == "remote" or each.unit)]
    yield from _differ(where, side, running, "ros2-mixed-domains", "ROS_DOMAIN_ID", "domain", domain_of)
    yield from _differ(
        where, side, running, "ros2-mixed-middlewares", "RMW_IMPLEMENTATION", "middleware", middleware_of
    )
    releases = sorted({each.distro for each in running if each.distro})
    if len(releases) > 1 and any(each in OLD_RELEASES for each in releases):
        old = next(each for each in releases if each in OLD_RELEASES)
        stray = [each for each in running if each.distro == old]
        yield Finding(
            "ros2-mixed-releases",
            f"{side.name}: {_list(releases)} run in one network of nodes, and {_name(old)} does not mix with newer "
            f"releases: {_processes(stray)}",
            "start all nodes with one release; source its setup.bash alone in the unit or the shell file, or give the "
            "nodes of the older release a ROS_DOMAIN_ID of their own",
            tuple(_stop(where, stray)),
        )


def _differ(
    where: Where,
    side: Side,
    running: list[Process],
    rule: str,
    variable: str,
    what: str,
    read: Callable[[Mapping[str, str]], str],
) -> Iterator[Finding]:
    found: dict[str, list[Process]] = {}
    for each in running:
        found.setdefault(read(each.variables), []).append(each)
    if len(found) < 2:
        return
    common = read(side.ros2.variables)
    for value, stray in sorted(found.items()):
        if value != common:
            lines = tuple(_set_in_unit(where, each, variable, common) for each in stray if each.unit)
            yield Finding(
                rule,
                f"{side.name}: {_processes(stray)} is in {what} {value}, the other nodes there in {common}; they do "
                "not discover one another",
                f"start it with {variable}={common}" + ("; it belongs to a systemd unit:" if lines else ""),
                lines,
            )


def _set_in_unit(where: Where, process: Process, variable: str, value: str) -> FixCommand:
    folder = f"/etc/systemd/system/{process.unit}.d"
    text = quote(f"[Service]\nEnvironment={variable}={value}\n")
    line = (
        f"mkdir -p {quote(folder)} && printf %s {text} >{quote(folder)}/ros2.conf && systemctl daemon-reload && "
        f"systemctl restart {quote(process.unit)}"
    )
    return FixCommand(where, line, root=True)


def _stop(where: Where, processes: list[Process]) -> Iterator[FixCommand]:
    for unit in sorted({each.unit for each in processes if each.unit}):
        yield FixCommand(where, f"systemctl disable --now {quote(unit)}", root=True)


def check_variables(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check for variables with unusable values."""
    ros2 = side.ros2
    if not ros2.present:
        return
    places = (("of running nodes", ros2.variables), ("in a new terminal", ros2.shell))
    for index, (what, variables) in enumerate(places):
        if index and variables == places[0][1]:
            return
        found = list(_check_values(side, variables, what))
        yield from found
        if found:
            return


def _check_values(side: Side, variables: Mapping[str, str], what: str) -> Iterator[Finding]:
    domain = domain_of(variables)
    number = parse_integer(domain)
    if number is None or not 0 <= number <= HIGHEST_DOMAIN:
        yield Finding(
            "ros2-bad-domain",
            f"{side.name}: ROS_DOMAIN_ID {what} is {domain}, expected a number from 0 to {HIGHEST_DOMAIN}",
            _change(side, "ROS_DOMAIN_ID", "a number in that range, the same on all computers of this robot"),
        )
    middleware = middleware_of(variables)
    installed = {each for release in side.ros2.installations for each in release.middlewares}
    if installed and middleware not in installed:
        distro = side.ros2.distro
        package = f"ros-{distro}-{middleware.replace('_', '-')}"
        yield Finding(
            "ros2-no-middleware",
            f"{side.name}: RMW_IMPLEMENTATION {what} is {middleware}, which is not installed there; nodes do not "
            f"start. "
            f"Installed: {_list(sorted(installed))}",
            f"sudo apt-get install {package}; or {_change(side, 'RMW_IMPLEMENTATION', sorted(installed)[0])}",
        )


def check_needs(where: Where, side: Side) -> Iterator[Finding]:
    """Check the files and servers that the variables refer to."""
    for path, present in side.ros2.files.items():
        if not present:
            yield Finding(
                "ros2-no-profile",
                f"{side.name}: the settings file {path} of the middleware does not exist; nodes do not start, or start "
                "with other settings",
                "write it, or "
                + _change(side, "FASTRTPS_DEFAULT_PROFILES_FILE or CYCLONEDDS_URI", "a file that exists, or nothing"),
            )
    variables = side.ros2.variables
    if middleware_of(variables) == ZENOH and side.ros2.processes and ZENOH_PORT not in side.ros2.ports:
        distro = side.ros2.distro or "jazzy"
        yield Finding(
            "ros2-no-zenoh-router",
            f"{side.name}: its nodes use {ZENOH}, and no Zenoh router listens at port {ZENOH_PORT}; nodes do not "
            "discover one another",
            "start the router before the nodes, as a unit of its own:",
            (FixCommand(where, f"bash -c '. /opt/ros/{distro}/setup.bash && ros2 run {ZENOH} rmw_zenohd'"),),
        )
    for host, port in _servers(variables):
        own = {"127.0.0.1", "localhost", side.name, f"{side.name}.local", *side.addresses}
        if host in own and port not in side.ros2.ports:
            yield Finding(
                "ros2-no-discovery-server",
                f"{side.name}: ROS_DISCOVERY_SERVER is {host}:{port}, and no server listens there; nodes do not "
                "discover one another",
                "start the server, or remove the variable:",
                (FixCommand(where, f"fastdds discovery --udp-address 0.0.0.0 --udp-port {port}"),),
            )
    for device in side.ros2.no_multicast:
        yield Finding(
            "ros2-multicast-off",
            f"{side.name}: the network interface {device} takes no part in multicast; nodes of other computers are "
            "not discovered through it",
            commands=(FixCommand(where, f"ip link set {quote(device)} multicast on", root=True, safe=True),),
        )


def check_memory(where: Where, side: Side) -> Iterator[Finding]:
    """Check for units whose shared memory systemd removes when a login ends; Fast DDS sends nothing without it."""
    for user in side.ros2.forgotten:
        running = [each for each in side.ros2.processes if each.user == user and each.unit]
        running = [each for each in running if middleware_of(each.variables).startswith(_FAST_DDS)]
        if running:
            yield Finding(
                "ros2-removed-memory",
                f"{side.name}: when the last login of {user} ends, systemd removes the shared memory of that user's "
                f"units, and the nodes of {_processes(running)} fall silent",
                "let the user's processes outlive the logins (RemoveIPC in logind.conf(5)); nodes that are silent "
                "already have to be started again:",
                (FixCommand(where, f"loginctl enable-linger {quote(user)}", root=True, safe=True),),
            )


def check_lost_memory(where: Where, side: Side) -> Iterator[Finding]:
    """Check for nodes whose shared memory was removed while they ran: later local nodes cannot reach them."""
    lost = [each for each in side.ros2.processes if each.lost]
    if lost:
        units = sorted({each.unit for each in lost if each.unit})
        yield Finding(
            "ros2-lost-memory",
            f"{side.name}: the shared memory of {_processes(lost)} was removed while it ran; what nodes send that "
            "start there later does not arrive",
            "start it again:" if units else "start it again",
            tuple(FixCommand(where, f"systemctl restart {quote(unit)}", root=True) for unit in units),
        )


def _servers(variables: Mapping[str, str]) -> Iterator[tuple[str, int]]:
    for text in variables.get("ROS_DISCOVERY_SERVER", "").split(";"):
        if text.strip():
            try:
                parts = urlsplit(
                    f"udp://{text.strip().removeprefix('UDPv4:[').removeprefix('TCPv4:[').replace(']', '')}"
                )
                yield parts.hostname or "", parts.port or SERVER_PORT
            except ValueError:
                continue


def _change(side: Side, variable: str, value: str) -> str:
    files = [file for file, name in side.ros2.settings if name in variable]
    return f"set {variable} to {value}" + (f" (it is set in {', '.join(files)})" if files else "")


def _processes(processes: list[Process]) -> str:
    shown = [each.unit or each.argv[:80] for each in processes]
    shown = list(dict.fromkeys(shown))
    return ", ".join(shown[:SHOWN]) + (" ..." if len(shown) > SHOWN else "")


def _name(distro: str) -> str:
    return NAMES.get(distro, distro)


def _list(texts: list[str]) -> str:
    return " and ".join(_name(each) for each in texts)


RULES: tuple[Rule, ...] = (
    SideRule(
        {
            "ros2-mixed-domains": "nodes of one computer are in different domains",
            "ros2-mixed-middlewares": "nodes of one computer use different middlewares",
            "ros2-mixed-releases": "Humble or older runs beside a newer release",
        },
        check_processes,
        simulation=True,
    ),
    SideRule(
        {
            "ros2-bad-domain": "ROS_DOMAIN_ID is no number that works",
            "ros2-no-middleware": "RMW_IMPLEMENTATION names a middleware that is not installed",
        },
        check_variables,
        simulation=True,
    ),
    SideRule(
        {
            "ros2-no-profile": "a settings file of the middleware does not exist",
            "ros2-no-zenoh-router": "nodes use Zenoh, and its router does not run",
            "ros2-no-discovery-server": "ROS_DISCOVERY_SERVER names this computer, where no server listens",
            "ros2-multicast-off": "a network interface takes no part in multicast",
        },
        check_needs,
    ),
    SideRule(
        {"ros2-removed-memory": "systemd removes the shared memory of units when a login ends"},
        check_memory,
        simulation=True,
    ),
    SideRule(
        {"ros2-lost-memory": "the shared memory of a running node was removed"}, check_lost_memory, simulation=True
    ),
)
