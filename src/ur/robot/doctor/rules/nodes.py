"""The host names under which running nodes are registered: a node whose name cannot be resolved sends no data."""

from collections.abc import Iterator

from ur.robot.doctor.findings import AdvertisedNode, ComputerPair, Finding, FixCommand
from ur.robot.doctor.rules.registry import PairRule, Rule
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


RULES: tuple[Rule, ...] = (
    PairRule(
        {"unresolvable-node": "a running node advertises a name that one of the two does not know"},
        check_advertised,
        ros1=True,
    ),
)
