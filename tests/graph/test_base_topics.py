"""Topics that nodes of ours publish because of their base."""

from ur.graph.text import draw_graph
from ur.graph.topics import find_base_uses, graph_plan
from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.memory import MemoryWorld
from ur.request.programs import PACKAGE

PARAMS = """<param name="base" value="{base}"/><param name="variant" value="{variant}"/>
<param name="package" value="{package}"/><param name="robots" value="{robots}"/>"""


def load(kind: str = "simulator", base: str = "magni", variant: str = "", robots: int = 1, more: str = "") -> Plan:
    params = PARAMS.format(base=base, variant=variant, package=PACKAGE, robots=robots)
    text = f'<launch><node name="node" pkg="ubiquity_launches" type="{kind}">{params}{more}</node></launch>'
    return load_plan(["/a.launch"], [], MemoryWorld({"/a.launch": text}))


def topics(plan: Plan, use: str = "publishes") -> set[str]:
    params = {param.name: param.value for param in plan.params}
    return {each.name for each in find_base_uses(plan.nodes[0], params) if each.use == use}


def test_simulator_publishes_a_scan_when_the_base_has_a_lidar() -> None:
    assert "/scan" in topics(load(variant="lidar"))
    assert "/scan" not in topics(load())


def test_simulator_publishes_what_the_base_has() -> None:
    assert {"/sonars", "/battery_state", "/raspicam_node/image/compressed", "/odom"} <= topics(load())
    assert {"/scan", "/bumper/left_front", "/bumper/right_side", "/cliff/left"} <= topics(load(base="botvac"))
    assert topics(load(), "subscribes") == {"/cmd_vel"}


def test_simulator_of_several_robots_publishes_in_a_namespace_for_each() -> None:
    labels = {box.label for box in graph_plan(load(variant="lidar", robots=2)).boxes}
    assert {"/robot_0/scan", "/robot_1/scan", "/robot_1/cmd_vel", "/tf", "/node/pause"} <= labels
    assert not {"/scan", "/odom", "/cmd_vel"} & labels


def test_remap_of_the_simulator_is_followed() -> None:
    plan = load(variant="lidar", more='<remap from="scan" to="lidar"/>')
    assert "/lidar" in topics(plan)
    assert all(arrow.sure for arrow in graph_plan(plan).arrows)


def test_scan_is_in_doubt_where_the_base_is_not_known() -> None:
    lines = ["".join(piece for piece, _ in line) for line in draw_graph(graph_plan(load(base="nonesuch")))]
    assert "  → /scan (perhaps: only if the base has a lidar)" in lines


def test_driver_adapter_publishes_what_its_parameters_ask_for() -> None:
    assert topics(load("driver_adapter", variant="lidar")) == {"/joint_states"}
    rename = '<param name="rename_scan" value="true"/>'
    assert topics(load("driver_adapter", variant="lidar", more=rename)) == {"/joint_states", "/scan"}
    assert topics(load("driver_adapter", more=rename)) == {"/joint_states"}


def test_simulator_as_devices_publishes_the_truth_only() -> None:
    plan = load(more='<param name="devices" value="true"/>')
    assert topics(plan) == {"/base_pose_ground_truth", "/node/collisions"}
    assert topics(plan, "subscribes") == set()


def test_base_driver_publishes_what_the_base_has() -> None:
    assert topics(load("base_driver")) == {"/odom", "/joint_states", "/tf", "/battery_state"}
    assert {"/bumper/left_front", "/cliff/left"} <= topics(load("base_driver", base="botvac"))
    assert topics(load("base_driver", base="nonesuch")) == {"/odom", "/joint_states", "/tf"}
    assert topics(load("base_driver"), "subscribes") == {"/cmd_vel"}


def test_lidar_driver_publishes_the_scan_of_the_base() -> None:
    assert topics(load("lidar_driver", variant="lidar")) == {"/scan"}
    assert topics(load("lidar_driver", base="nonesuch")) == {"/scan"}


def test_drivers_of_single_sensors_publish_the_topics_of_the_base() -> None:
    assert topics(load("sonar_driver")) == topics(load("sonar_driver", base="nonesuch")) == {"/sonars"}
    assert topics(load("imu_driver", base="nonesuch")) == {"/imu/data"}


def test_parameters_ask_for_clock_transforms_and_bumpers() -> None:
    assert "/clock" in topics(load(more='<param name="publish_clock" value="true"/>'))
    more = '<param name="publish_tf" value="true"/><param name="bumper_messages" value="Bumper"/>'
    plan = load("driver_adapter", base="botvac", more=more)
    assert {"/tf", "/bumper/left_front"} <= topics(plan)
    assert "/driver/bumpers" in topics(plan, "subscribes")
