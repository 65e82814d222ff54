"""A healthy ROS 2 robot and laptop, and each fault that the doctor names."""

from collections.abc import Mapping
from dataclasses import replace

from tests.robot.doctor.pairs import LAPTOP, PAIR, ROBOT

from ur.robot.doctor.findings import ComputerPair
from ur.robot.ros2.seen_graph import End, Installation, Process, Qos, Received, Ros2, SeenFrame, SeenGraph, SeenTopic

TWIST, STAMPED, SCAN = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped", "sensor_msgs/msg/LaserScan"
JAZZY = Installation("jazzy", "/opt/ros/jazzy", ("rmw_cyclonedds_cpp", "rmw_fastrtps_cpp"))
DOMAIN = {"ROS_DOMAIN_ID": "7"}
LOOSE = Qos(reliable=False)


def process(distro: str = "jazzy", unit: str = "base.service", **variables: str) -> Process:
    return Process(700, "ros", "/opt/ros/jazzy/lib/base/base --ros-args", distro, unit, {**DOMAIN, **variables})


def twist(publisher: str = "/cmd_vel_mux", subscriber: str = "/base") -> SeenTopic:
    return SeenTopic("/cmd_vel", (End(publisher, TWIST, "RIHS01_9c"),), (End(subscriber, TWIST, "RIHS01_9c"),))


GRAPH = SeenGraph(
    nodes=("/base", "/cmd_vel_mux", "/lidar", "/slam"),
    topics=(
        twist(),
        SeenTopic("/map", (End("/slam", "nav_msgs/msg/OccupancyGrid", qos=Qos(latched=True)),)),
        SeenTopic("/scan", (End("/lidar", SCAN, qos=LOOSE),), (End("/slam", SCAN, qos=LOOSE),)),
    ),
    simulated={"/base": False, "/slam": False},
    states={"/slam": "active"},
    scans={"/scan": Received(20, 0.05)},
    charge={"/battery_state": 0.8},
    frames={"base_link": SeenFrame(("/base",), ("odom",)), "odom": SeenFrame(("/slam",), ("map",))},
)
RUNNING = Ros2((JAZZY,), (process(), process(unit="lidar.service")), DOMAIN, graph=GRAPH, receives=True)
TOOLS = Ros2((JAZZY,), shell=DOMAIN, called=DOMAIN, receives=True)
NO_ROS1 = {"openssh-server": "1"}
HERE = replace(LAPTOP, ros={}, packages=NO_ROS1, messages={}, ros2=TOOLS)
THERE = replace(ROBOT, ros={}, packages=NO_ROS1, messages={}, ros_setup=None, ros2=RUNNING)
ROS2_PAIR = replace(PAIR, local=HERE, remote=THERE, reaches_local=False, reaches_remote=False, way_back="refused")


def remote(**changes: object) -> ComputerPair:
    return replace(ROS2_PAIR, remote=replace(THERE, ros2=replace(RUNNING, **changes)))  # type: ignore[arg-type] # a test's own keywords


def local(variables: Mapping[str, str] | None = None, **changes: object) -> ComputerPair:
    called = {**DOMAIN, **(variables or {})}
    ros2 = replace(TOOLS, called=called, shell=called, **changes)  # type: ignore[arg-type] # a test's own keywords
    return replace(ROS2_PAIR, local=replace(HERE, ros2=ros2))


def both(
    variables: Mapping[str, str],
    ports: tuple[int, ...] = (),
    *,
    mine: Mapping[str, str] | None = None,
    forgotten: tuple[str, ...] = (),
) -> ComputerPair:
    """All processes of the robot, and this shell, with these variables; `mine` are those of this shell."""
    robot = replace(RUNNING, processes=(process(**variables),), ports=frozenset(ports), forgotten=forgotten)
    called = {**DOMAIN, **(variables if mine is None else mine)}
    laptop = replace(TOOLS, called=called, ports=frozenset(ports))
    return replace(ROS2_PAIR, local=replace(HERE, ros2=laptop), remote=replace(THERE, ros2=robot))


def graph(**changes: object) -> ComputerPair:
    return remote(graph=replace(GRAPH, **changes))  # type: ignore[arg-type] # a test's own keywords


def topics(*changed: SeenTopic) -> ComputerPair:
    names = {each.name for each in changed}
    return graph(topics=(*changed, *(each for each in GRAPH.topics if each.name not in names)))


def scans(offered: Qos, requested: Qos) -> ComputerPair:
    return topics(SeenTopic("/scan", (End("/lidar", SCAN, qos=offered),), (End("/slam", SCAN, qos=requested),)))


HUMBLE = Installation("humble", "/opt/ros/humble", ("rmw_fastrtps_cpp",))
FASTDDS_ALONE = replace(JAZZY, middlewares=("rmw_fastrtps_cpp",))
ZENOH = {"RMW_IMPLEMENTATION": "rmw_zenoh_cpp"}
WITH_ZENOH = replace(JAZZY, middlewares=("rmw_fastrtps_cpp", "rmw_zenoh_cpp"))
SERVER = {"ROS_DISCOVERY_SERVER": "127.0.0.1:11811"}
PROFILE = "/home/ros/fastdds.xml"
CLOCK = SeenTopic("/clock", (End("/simulator", "rosgraph_msgs/msg/Clock"),))

# Each is one seeded fault: the finding that names it, and the pair.
CASES: list[tuple[str, ComputerPair]] = [
    # How nodes discover one another on the robot.
    ("ros2-mixed-domains", remote(processes=(process(), process(), process(unit="lidar.service", ROS_DOMAIN_ID="0")))),
    (
        "ros2-mixed-middlewares",
        remote(processes=(process(), process(), process(unit="nav.service", RMW_IMPLEMENTATION="rmw_cyclonedds_cpp"))),
    ),
    ("ros2-mixed-releases", remote(processes=(process(), process(), process("humble", "old.service")))),
    ("ros2-bad-domain", both({"ROS_DOMAIN_ID": "150"})),
    (
        "ros2-no-middleware",
        remote(installations=(FASTDDS_ALONE,), shell={**DOMAIN, "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"}),
    ),
    ("ros2-no-profile", remote(files={PROFILE: False})),
    ("ros2-multicast-off", remote(no_multicast=("wlan0",))),
    ("ros2-removed-memory", remote(forgotten=("ros",))),
    ("ros2-lost-memory", remote(processes=(replace(process(), lost=True),))),
    # Between the two computers.
    ("ros2-release-mix", local(installations=(HUMBLE,))),
    ("ros2-domain", local({"ROS_DOMAIN_ID": "0"})),
    ("ros2-middleware", local({"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"})),
    ("ros2-local-only", local({"ROS_LOCALHOST_ONLY": "1"})),
    ("ros2-local-only", both({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, mine={})),
    ("ros2-no-multicast", local(receives=False)),
    ("ros2-discovery-server", both(SERVER, (11811,), mine={})),
    ("ros2-discovery-server", local(SERVER, ports=frozenset({11811}))),
    ("ros2-no-discovery-server", both(SERVER, (), mine={"ROS_DISCOVERY_SERVER": "bob.local:11811"})),
    # Topics that never connect.
    ("ros2-command-type", topics(SeenTopic("/cmd_vel", (End("/teleop", TWIST),), (End("/base", STAMPED),)))),
    ("ros2-command-type", topics(SeenTopic("/cmd_vel", (End("/nav", STAMPED),), (End("/base", TWIST),)))),
    (
        "ros2-topic-type",
        topics(SeenTopic("/mode", (End("/a", "std_msgs/msg/Bool"),), (End("/b", "std_msgs/msg/String"),))),
    ),
    (
        "ros2-definition",
        topics(
            SeenTopic("/bumper", (End("/a", "my_msgs/msg/B", "RIHS01_1"),), (End("/b", "my_msgs/msg/B", "RIHS01_2"),))
        ),
    ),
    ("ros2-qos", scans(LOOSE, Qos())),
    ("ros2-qos", scans(Qos(), Qos(latched=True))),
    ("ros2-qos", scans(Qos(), Qos(deadline=0.1))),
    ("ros2-qos", scans(Qos(deadline=0.5), Qos(deadline=0.1))),
    ("ros2-qos", scans(Qos(), Qos(manual=True))),
    ("ros2-qos", scans(Qos(lease=2.0), Qos(lease=1.0))),
    ("ros2-no-base", topics(SeenTopic("/cmd_vel", (End("/teleop", TWIST),)))),
    (
        "ros2-second-commander",
        topics(SeenTopic("/cmd_vel", (End("/cmd_vel_mux", TWIST), End("/script", TWIST)), (End("/base", TWIST),))),
    ),
    # Nodes, and what they send.
    ("ros2-no-graph", remote(graph=None, problem="No module named 'rclpy'")),
    ("ros2-same-name", graph(nodes=("/base", "/base", "/slam"))),
    ("ros2-no-clock", graph(simulated={"/slam": True})),
    ("ros2-mixed-time", graph(topics=(*GRAPH.topics, CLOCK), simulated={"/slam": True, "/base": False})),
    ("ros2-lifecycle", graph(states={"/map_server": "inactive", "/slam": "active"})),
    ("ros2-no-scan", graph(scans={"/scan": Received(0)})),
    ("ros2-no-scan", topics(SeenTopic("/scan", (), (End("/slam", SCAN, qos=LOOSE),)))),
    ("ros2-old-stamps", graph(scans={"/scan": Received(20, 4.2)})),
    ("ros2-low-battery", graph(charge={"/battery_state": 0.07})),
    ("ros2-low-battery", graph(charge={"/battery_state": 7.0})),
    ("ros2-two-parents", graph(frames={"base_link": SeenFrame(("/base", "/ekf"), ("odom", "odom_ekf"))})),
    ("ros2-two-senders", graph(frames={"base_link": SeenFrame(("/base", "/ekf"), ("odom",))})),
    ("clock-offset", replace(ROS2_PAIR, offset=3.0)),
]
ZENOH_CASE = (
    "ros2-no-zenoh-router",
    replace(
        ROS2_PAIR,
        local=replace(HERE, ros2=replace(TOOLS, called={**DOMAIN, **ZENOH}, installations=(WITH_ZENOH,))),
        remote=replace(THERE, ros2=replace(RUNNING, processes=(process(**ZENOH),), installations=(WITH_ZENOH,))),
    ),
)
CASES.append(ZENOH_CASE)
