"""Nodes of ROS 2 and their data: names, time, lifecycle states, scans, batteries, tf."""

from collections.abc import Iterator

from ur.robot.doctor.findings import Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.ros2.seen_graph import SeenGraph
from ur.robot.ssh.shell import quote

LOW_CHARGE = 0.15
OLD_SECONDS = 0.5  # as for clocks: tf refuses older data
SHOWN = 3
SCAN = "sensor_msgs/msg/LaserScan"
_STATES = {"unconfigured": "configure", "inactive": "activate"}
# Tools, which do not need simulated time, and wait for data of nodes that need not run.
_TOOLS = ("rviz", "rqt", "foxglove_bridge", "rosbridge_websocket", "ur_", "web_")


def check_graph(where: Where, side: Side) -> Iterator[Finding]:
    """Check that the graph can be read, and check its nodes."""
    ros2 = side.ros2
    if ros2.processes and ros2.graph is None and ros2.problem:
        yield Finding(
            "ros2-no-graph",
            f"{side.name}: processes of ROS 2 run, and their graph cannot be read: {ros2.problem}",
            "does 'ros2 node list' work there? The setup.bash of its release must lie in /opt/ros/RELEASE",
        )
    if ros2.graph:
        yield from _check_names(side, ros2.graph)
        yield from _check_time(where, side, ros2.graph)
        yield from _check_states(where, side, ros2.graph)


def _check_names(side: Side, graph: SeenGraph) -> Iterator[Finding]:
    for name in sorted({each for each in graph.nodes if graph.nodes.count(each) > 1}):
        yield Finding(
            "ros2-same-name",
            f"{side.name}: {graph.nodes.count(name)} nodes have the name {name}; their parameters, services and tf "
            "get mixed up",
            f"end one of them, or start it as another: --ros-args -r __node:={name.rpartition('/')[2]}_2",
        )


def _check_time(where: Where, side: Side, graph: SeenGraph) -> Iterator[Finding]:
    timed = {node: value for node, value in graph.simulated.items() if not _is_tool(node)}
    clocks = next((topic.publishers for topic in graph.topics if topic.name == "/clock"), ())
    simulated = sorted(node for node, value in timed.items() if value)
    real = sorted(node for node, value in timed.items() if not value and node not in {end.node for end in clocks})
    if simulated and not clocks:
        yield Finding(
            "ros2-no-clock",
            f"{side.name}: {_list(simulated)} takes the time from /clock (use_sim_time), and no node publishes it; "
            "timers stop and tf refuses data",
            "start the simulator or the recording, or give the node the computer's time:",
            tuple(_set_time(where, side, simulated, "false")),
        )
    elif simulated and real:
        yield Finding(
            "ros2-mixed-time",
            f"{side.name}: {_list(simulated)} has simulated time and {_list(real)} has not (use_sim_time); tf refuses "
            "data of one half",
            "give all nodes the same time:",
            tuple(_set_time(where, side, real, "true")),
        )


def _set_time(where: Where, side: Side, nodes: list[str], value: str) -> Iterator[FixCommand]:
    for node in nodes[:SHOWN]:
        yield FixCommand(where, _ros2(side, "param", "set", node, "use_sim_time", value))


def _check_states(where: Where, side: Side, graph: SeenGraph) -> Iterator[Finding]:
    for node, state in sorted(graph.states.items()):
        if state == "active":
            continue
        change = _STATES.get(state)
        yield Finding(
            "ros2-lifecycle",
            f"{side.name}: the managed node {node} is {state or 'in no known state'}, expected active; it sends and "
            "takes nothing",
            "its manager (Nav2: lifecycle_manager, autostart) has not started it; its output says why, or:"
            if change
            else "start it again; its output says why it ended",
            (FixCommand(where, _ros2(side, "lifecycle", "set", node, change)),) if change else (),
        )


def check_data(where: Where, side: Side) -> Iterator[Finding]:
    """Check the data that nodes send: scans, batteries, tf."""
    graph = side.ros2.graph
    if graph is None:
        return
    for topic in graph.topics:
        kinds = {end.kind for end in (*topic.publishers, *topic.subscribers)}
        scan = graph.scans.get(topic.name)
        waiting = [end.node for end in topic.subscribers if not _is_tool(end.node)]
        if SCAN in kinds and waiting and not topic.publishers:
            yield Finding(
                "ros2-no-scan",
                f"{side.name}: {waiting[0]} waits for scans on {topic.name}, and no node publishes them",
                "start the lidar's driver; one that publishes another name or namespace is remapped: "
                f"--ros-args -r scan:={topic.name}",
            )
        elif scan is not None and topic.publishers and scan.messages == 0:
            yield Finding(
                "ros2-no-scan",
                f"{side.name}: {topic.publishers[0].node} publishes {topic.name}, and no scan arrived within some "
                "seconds",
                "does the lidar turn, and is its cable plugged in? The driver's output says more; 'ur devices' lists "
                "the devices",
            )
        elif (
            scan is not None
            and scan.age is not None
            and abs(scan.age) > OLD_SECONDS
            and not any(graph.simulated.values())
        ):
            side_of = "behind" if scan.age > 0 else "ahead of"
            driver = topic.publishers[0].node if topic.publishers else "its driver"
            yield Finding(
                "ros2-old-stamps",
                f"{side.name}: stamps on {topic.name} of {driver} "
                f"are {abs(scan.age):.1f} s {side_of} the clock of {side.name}; tf refuses the data",
                "the computer of the driver has another clock (the base of TurtleBot 4 and Create 3 is one of its own: "
                "give it this computer as NTP server):",
                (FixCommand(where, "chronyc sources"),),
            )
    for name, charge in sorted(graph.charge.items()):
        share = charge / 100 if charge > 1.5 else charge  # some drivers send percent
        if 0 <= share < LOW_CHARGE:
            yield Finding(
                "ros2-low-battery",
                f"{side.name}: the battery on {name} is at {share:.0%}, expected {LOW_CHARGE:.0%} or more",
                "charge it; a computer that loses its supply may lose files",
            )
    yield from _check_frames(side, graph)


def _check_frames(side: Side, graph: SeenGraph) -> Iterator[Finding]:
    for child, frame in sorted(graph.frames.items()):
        if len(frame.parents) > 1:
            yield Finding(
                "ros2-two-parents",
                f"{side.name}: tf has the frame {child} in {_list(frame.parents)}, sent by {_list(frame.senders)}; "
                "a frame has one parent",
                "switch one of them off (for instance publish_tf: false of the base's driver beside an EKF)",
            )
        elif len(frame.senders) > 1:
            yield Finding(
                "ros2-two-senders",
                f"{side.name}: {_list(frame.senders)} both send {frame.parents[0]} -> {child} to tf; the pose jumps",
                "switch one of them off (for instance publish_tf: false of the base's driver beside an EKF; a second "
                "robot_state_publisher)",
            )


def _is_tool(node: str) -> bool:
    return node.rpartition("/")[2].startswith(_TOOLS)


def _ros2(side: Side, *arguments: str) -> str:
    setup = next((each.folder for each in side.ros2.installations if each.distro == side.ros2.distro), "")
    variables = " ".join(
        f"{name}={quote(value)}"
        for name, value in side.ros2.variables.items()
        if name in ("ROS_DOMAIN_ID", "RMW_IMPLEMENTATION", "ROS_DISCOVERY_SERVER")
    )
    line = f"{variables} ros2 {quote(*arguments)}".strip()
    return f"bash -c {quote(f'. {quote(setup)}/setup.bash && {line}')}" if setup else line


def _list(texts: list[str] | tuple[str, ...]) -> str:
    shown = [*texts[:SHOWN]]
    if len(texts) > SHOWN:
        return ", ".join(shown) + " ..."
    return " and ".join([", ".join(shown[:-1]), shown[-1]] if len(shown) > 1 else shown)


RULES: tuple[Rule, ...] = (
    SideRule(
        {
            "ros2-no-graph": "nodes run, and their graph cannot be read",
            "ros2-same-name": "two nodes have one name",
            "ros2-no-clock": "nodes wait for a simulated clock that is not published",
            "ros2-mixed-time": "some nodes have simulated time, others not",
            "ros2-lifecycle": "a managed node is not active",
        },
        check_graph,
        simulation=True,
    ),
    SideRule(
        {
            "ros2-no-scan": "no scans arrive",
            "ros2-old-stamps": "stamps of scans are of another clock",
            "ros2-low-battery": "the battery is nearly empty",
            "ros2-two-parents": "a frame of tf has two parents",
            "ros2-two-senders": "two nodes send one frame of tf",
        },
        check_data,
        simulation=True,
    ),
)
