"""Names in ROS: variables in the shells of both computers, and host names of running nodes."""

from collections.abc import Iterator, Mapping
from urllib.parse import urlsplit

from ur.robot.doctor.findings import AdvertisedNode, ComputerPair, Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import PairRule, Rule
from ur.robot.doctor.side import Side
from ur.robot.setup.environment import robot_setup_text
from ur.robot.ssh.shell import quote

STUBBORN_SECONDS = 5


def check_advertised(pair: ComputerPair) -> Iterator[Finding]:
    """Check that both computers resolve the host name of each node."""
    addresses = {*pair.local.addresses, *pair.remote.addresses}
    for node in pair.advertised:
        lost = [
            (side.name, means)
            for side, means in ((pair.local, node.local), (pair.remote, node.remote))
            if not means & addresses
        ]
        if lost:
            takes = " and ".join(
                f"{name} takes that for {', '.join(sorted(means))}" if means else f"{name} does not know that name"
                for name, means in lost
            )
            yield _explain(node, takes, pair)


def _explain(node: AdvertisedNode, takes: str, pair: ComputerPair) -> Finding:
    message = f"node {node.node} says it is at {node.host}, and {takes}"
    owner = node.owner
    if owner is None:
        return Finding(
            "unresolvable-node", message, "start it again from a new shell, where ROS_HOSTNAME is right ('ur env')"
        )
    if owner.unit:
        return Finding(
            "unresolvable-node",
            message,
            "it was started before the name was as it is now:",
            (FixCommand(owner.where, f"systemctl restart {quote(owner.unit)}", root=True),),
        )
    side = pair.local if owner.where == "local" else pair.remote
    end = f"kill -INT {owner.pid}; timeout {STUBBORN_SECONDS} tail --pid={owner.pid} -f /dev/null || kill {owner.pid}"
    return Finding(
        "unresolvable-node",
        message,
        f"end it, then start it again from a new shell on {side.name}: {owner.words}",
        (FixCommand(owner.where, end),),
    )


_OWN_FILE = "/.ros_setup"


def check_robot(pair: ComputerPair) -> Iterator[Finding]:
    """Check the robot's variables: of nodes that roslaunch starts on it, and of its terminals."""
    side = pair.remote
    for what, variables in _environments(side, ("for nodes that roslaunch starts", "in a terminal")):
        found = list(_check_variables(side, variables, what, f"http://{side.name}.local:11311", side))
        for rule, variable, message in found:
            yield Finding(rule, message, _advice(side, variable), tuple(_fix(side, variable)))
        if found:
            return


def check_viewer(pair: ComputerPair) -> Iterator[Finding]:
    """Check this computer's variables if the robot is the selected one: of the calling shell, and of a new one."""
    side = pair.local
    if not pair.selected:
        return
    for what, variables in reversed(_environments(side, ("in this shell", "in a new terminal"))):
        found = list(_check_variables(side, variables, what, f"http://{pair.remote.name}.local:11311", pair.remote))
        for rule, variable, message in found:
            files = _files(side, variable)
            fresh = variables is side.shell
            commands = tuple(_comment(file, variable, "local") for file in files) if fresh else ()
            if not commands:
                commands = (FixCommand("local", "ur setup" if fresh else 'eval "$(ur env)"'),)
            help = "" if fresh else "this shell was opened before the robot was selected, or has values of its own:"
            yield Finding(rule, message, help, commands)
        if found:
            return


def _environments(side: Side, names: tuple[str, str]) -> list[tuple[str, Mapping[str, str]]]:
    """Return each observed set of variables by its name; if none was observed, the first name with an empty set."""
    known = list(zip(names, (side.ros, side.shell), strict=True))
    return [(what, variables) for what, variables in known if variables] or known[:1]


def _check_variables(
    side: Side, variables: Mapping[str, str], what: str, wanted: str, master: Side
) -> Iterator[tuple[str, str, str]]:
    """Yield (rule, variable, message) of each wrong variable of a computer whose master shall run on `master`."""
    full = f"{side.name}.local"
    uri = variables.get("ROS_MASTER_URI", "")
    allowed = {f"{master.name}.local", master.name, *master.addresses, *(["localhost"] if side is master else [])}
    if urlsplit(uri).hostname not in allowed:
        yield (
            "wrong-master",
            "ROS_MASTER_URI",
            f"{side.name}: ROS_MASTER_URI {what} is {uri or 'not set'}, expected {wanted}",
        )
    name, address = variables.get("ROS_HOSTNAME", ""), variables.get("ROS_IP", "")
    if not name and address:
        if address not in side.addresses:
            yield (
                "wrong-ros-ip",
                "ROS_IP",
                f"{side.name}: ROS_IP {what} is {address}, which is not its address ({', '.join(side.addresses)})",
            )
    elif name != full and name not in side.addresses:
        yield (
            "wrong-ros-hostname",
            "ROS_HOSTNAME",
            f"{side.name}: ROS_HOSTNAME {what} is {name or 'not set'}, which others do not know; expected {full}",
        )


def _files(side: Side, variable: str) -> list[str]:
    """Return the files other than this project's own that set a variable."""
    files = [each.file for each in side.settings if each.variable == variable and not each.file.endswith(_OWN_FILE)]
    return list(dict.fromkeys(files))


def _advice(side: Side, variable: str) -> str:
    files = _files(side, variable)
    return f"it is set in {', '.join(files)}; FILE.ur keeps the old text" if files else "~/.ros_setup is written again"


def _fix(side: Side, variable: str) -> Iterator[FixCommand]:
    yield from (_comment(file, variable, "remote") for file in _files(side, variable))
    wanted = robot_setup_text()
    if side.ros_setup != wanted or not _files(side, variable):
        lines = quote(*wanted.splitlines())
        yield FixCommand("remote", f"printf '%s\\n' {lines} >~/.ros_setup", safe=True)


def _comment(file: str, variable: str, where: Where) -> FixCommand:
    pattern = f"/^[[:space:]]*(export[[:space:]]+)?{variable}=/s/^/# /"
    return FixCommand(where, f"sed -i.ur -E {quote(pattern)} {quote(file)}", root=file.startswith("/etc/"))


RULES: tuple[Rule, ...] = (
    PairRule(
        {
            "wrong-master": "shells use another ROS master",
            "wrong-ros-ip": "nodes tell an address that is not their computer's",
            "wrong-ros-hostname": "nodes tell a name that others do not know",
        },
        lambda pair: [*check_robot(pair), *check_viewer(pair)],
        ros1=True,
    ),
    PairRule(
        {"unresolvable-node": "a running node advertises a name that one of the two does not know"},
        check_advertised,
        ros1=True,
    ),
)
