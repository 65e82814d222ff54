"""Discovery between the nodes of two computers that both have ROS 2."""

from collections.abc import Iterator, Mapping

from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand
from ur.robot.doctor.rules.registry import PairRule, Rule
from ur.robot.doctor.side import Side
from ur.robot.ros2.seen_graph import NAMES, domain_of, middleware_of, mixes, peers_of, range_of
from ur.robot.ssh.shell import quote

_FOLLOW = "of a shell that follows the robot: "
_LINK = "the page, the keys and 'ur' itself need none of this: they use the ssh connection"


def check_both(pair: ComputerPair) -> Iterator[Finding]:
    """Check the settings of this shell against those of the robot's nodes, where the robot is selected."""
    local, remote = pair.local, pair.remote
    if not (local.ros2.present and remote.ros2.present and pair.selected):
        return
    mine, theirs = (local.ros2.called or local.ros2.shell), remote.ros2.variables
    yield from _check_releases(local, remote)
    if (own := domain_of(mine)) != (other := domain_of(theirs)):
        message = f"ROS_DOMAIN_ID in this shell is {own}, and {other} for the nodes of {remote.name}"
        yield _set_local("ros2-domain", message, local, "ROS_DOMAIN_ID", other)
    if (own := middleware_of(mine)) != (other := middleware_of(theirs)):
        message = f"RMW_IMPLEMENTATION in this shell is {own}, and {other} for the nodes of {remote.name}"
        installed = {each for release in local.ros2.installations for each in release.middlewares}
        package = f"ros-{local.ros2.distro}-{other.replace('_', '-')}"
        lack = f"; first: sudo apt-get install {package}" if installed and other not in installed else ""
        yield _set_local("ros2-middleware", message + lack, local, "RMW_IMPLEMENTATION", other)
        return  # the following checks concern a single middleware
    yield from _check_servers(pair, mine, theirs)
    yield from _check_range(pair, mine, theirs)


def _check_releases(local: Side, remote: Side) -> Iterator[Finding]:
    mine, theirs = local.ros2.distro, remote.ros2.distro
    if not mixes(mine, theirs):
        names = [NAMES.get(each, each) for each in (mine, theirs)]
        yield Finding(
            "ros2-release-mix",
            f"{local.name} has ROS 2 {names[0]} and {remote.name} {names[1]}: nodes of the two raise exceptions when "
            "they discover one another, and their topics do not connect",
            f"keep them apart (another ROS_DOMAIN_ID here), or have one release on both; {_LINK}",
        )


def _check_servers(pair: ComputerPair, mine: Mapping[str, str], theirs: Mapping[str, str]) -> Iterator[Finding]:
    own, other = (each.get("ROS_DISCOVERY_SERVER", "") for each in (mine, theirs))
    if bool(own) != bool(other):
        if other:
            shown = other.replace("127.0.0.1", f"{pair.remote.name}.local").replace(
                "localhost", f"{pair.remote.name}.local"
            )
            message = f"the nodes of {pair.remote.name} use the discovery server {other}, and this shell none"
            yield _set_local("ros2-discovery-server", message, pair.local, "ROS_DISCOVERY_SERVER", shown)
        else:
            yield Finding(
                "ros2-discovery-server",
                f"this shell uses the discovery server {own}, and the nodes of {pair.remote.name} use none",
                "start the robot's nodes with the same ROS_DISCOVERY_SERVER, or use none here:",
                (FixCommand("local", "unset ROS_DISCOVERY_SERVER"),),
            )


def _check_range(pair: ComputerPair, mine: Mapping[str, str], theirs: Mapping[str, str]) -> Iterator[Finding]:
    local, remote = pair.local, pair.remote
    if mine.get("ROS_DISCOVERY_SERVER") and theirs.get("ROS_DISCOVERY_SERVER"):
        return
    for where, side, variables, other in (("local", local, mine, remote), ("remote", remote, theirs, local)):
        if range_of(variables) in ("LOCALHOST", "OFF"):
            name = (
                "ROS_LOCALHOST_ONLY" if variables.get("ROS_LOCALHOST_ONLY") == "1" else "ROS_AUTOMATIC_DISCOVERY_RANGE"
            )
            new = "0" if name == "ROS_LOCALHOST_ONLY" else "SUBNET"
            files = [file for file, variable in side.ros2.settings if variable == name]
            help = f"start its nodes with {name}={new}" + (f"; it is set in {', '.join(files)}" if files else "")
            commands = (FixCommand("local", f"export {name}={new}"),) if where == "local" else ()
            yield Finding(
                "ros2-local-only",
                f"{side.name}: {name} is {variables[name]}, so nodes of {other.name} are not discovered",
                f"{help}; {_LINK}",
                commands,
            )
            return
    silent = [side for _, side, _ in pair.sides() if side.ros2.receives is False]
    known = {f"{remote.name}.local", remote.name, *remote.addresses}
    if silent and not known & {*peers_of(mine)}:
        names = " and ".join(side.name for side in silent)
        yield Finding(
            "ros2-no-multicast",
            f"multicast packets do not arrive at {names}: nodes of the two do not discover one another",
            f"the access point or a guest network drops them; name the peers instead (Jazzy and later), as 'ur env' "
            f"does, or a discovery server on the robot; {_LINK}",
            (
                FixCommand("local", f"export ROS_STATIC_PEERS={quote(f'{remote.name}.local')}"),
                FixCommand("remote", f"export ROS_STATIC_PEERS={quote(f'{local.name}.local')}"),
            ),
        )


def _set_local(rule: str, message: str, side: Side, variable: str, value: str) -> Finding:
    files = [file for file, name in side.ros2.settings if name == variable]
    help = f"it is set in {', '.join(files)}; " if files else ""
    return Finding(rule, message, f"{help}{_FOLLOW}", (FixCommand("local", f"export {variable}={quote(value)}"),))


RULES: tuple[Rule, ...] = (
    PairRule(
        {
            "ros2-release-mix": "one of the two has Humble or older, the other a newer release",
            "ros2-domain": "the two are in different domains",
            "ros2-middleware": "the two use different middlewares",
            "ros2-discovery-server": "one of the two uses a discovery server",
            "ros2-local-only": "nodes of one computer are hidden from the other",
            "ros2-no-multicast": "the network drops multicast, which discovery needs",
        },
        check_both,
    ),
)
