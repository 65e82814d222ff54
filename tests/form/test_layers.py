"""Imports point down: what each package may import."""

import re
from collections.abc import Iterator, Mapping, Set

import pytest
from tests.form.facts import ROOT, Facts

# A module may import from the layers named here and from its own.
MAY_IMPORT: dict[str, tuple[str, ...]] = {
    "ur.source": (),
    "ur.launchfile.syntax": ("ur.source",),
    "ur.launchfile.world": ("ur.source",),
    "ur.launchfile.plan": ("ur.source", "ur.launchfile.syntax", "ur.launchfile.world"),
    "ur.launchfile.ros2": (*("ur.source", "ur.launchfile.syntax", "ur.launchfile.world", "ur.launchfile.plan"),),
    "ur.launchfile": ("ur.source",),
    "ur.system": ("ur.source",),
    "ur.devices": ("ur.source",),
    "ur.robot": ("ur.source", "ur.system", "ur.devices"),
    "ur.worlds": ("ur.source",),
    "ur.recordings": ("ur.source",),
    "ur.report": ("ur.source", "ur.recordings", "ur.run.master", "ur.run.record"),
    "ur.fleet": ("ur.source", "ur.system.child_processes"),
    "ur.maps": ("ur.source", "ur.worlds"),
    "ur.check": ("ur.source", "ur.launchfile", "ur.robot", "ur.worlds"),
    "ur.tools.new": ("ur.source", "ur.launchfile", "ur.robot", "ur.request", "ur.run.master"),
    "ur.tools.package": ("ur.source", "ur.launchfile", "ur.check"),
    "ur.graph": ("ur.source", "ur.launchfile", "ur.robot"),
    "ur.complete": (
        *("ur.source", "ur.launchfile", "ur.robot", "ur.worlds", "ur.maps", "ur.check", "ur.run"),
        "ur.request",
    ),
    "ur.docs": ("ur.source", "ur.launchfile", "ur.check", "ur.graph"),
    "ur.tools.find": ("ur.source", "ur.launchfile", "ur.check", "ur.tools.format"),
    "ur.tools.format": ("ur.source", "ur.launchfile", "ur.check"),
    "ur.tools.convert": ("ur.source", "ur.launchfile", "ur.check"),
    "ur.lsp": (
        "ur.source",
        "ur.launchfile",
        "ur.check",
        "ur.complete",
        "ur.tools.find",
        "ur.tools.format",
        "ur.tools.new.node_defaults",
    ),
    "ur.run": ("ur.source", "ur.recordings", "ur.launchfile", "ur.robot", "ur.system"),
    "ur.tui.screen": ("ur.source",),
    "ur.web": ("ur.source", "ur.recordings", "ur.maps", "ur.mcp", "ur.run", "ur.system"),
    "ur.mcp": ("ur.source", "ur.system"),
    "ur.tui": ("ur.source", "ur.run"),
    "ur.request": ("ur.source", "ur.system", "ur.launchfile", "ur.robot", "ur.maps", "ur.worlds", "ur.run"),
    "ur.get": ("ur.source", "ur.launchfile", "ur.request"),
    "ur.cli": ("ur",),
    "ur": ("ur",),
    "ur_nodes.geometry": ("ur.source", "ur.worlds"),
    "ur_nodes.ports": ("ur.source", "ur_nodes.geometry"),
    "ur_nodes.memory": ("ur_nodes.goal_topics", "ur_nodes.ports"),
    "ur_nodes.file_facts": ("ur.source.replace", "ur.system"),
    "ur_nodes.one_process": (
        *("ur.source", "ur.system"),
        *("ur_nodes.file_facts", "ur_nodes.loop", "ur_nodes.memory", "ur_nodes.ports"),
    ),
    "ur_nodes.fork_server": ("ur.run.host", "ur_nodes.run"),
    "ur_nodes.ros1": (
        "ur.source",
        "ur_nodes.geometry",
        "ur_nodes.loop",
        "ur_nodes.node_base",
        "ur_nodes.ports",
        "ur_nodes.codecs",
    ),
    "ur_nodes.ros1.repairs": ("ur.source", "ur.robot.addresses"),
    "ur_nodes.loop": (),
    "ur_nodes.node_base": ("ur_nodes.loop", "ur_nodes.ports"),
    "ur_nodes.codecs": ("ur.source", "ur_nodes.geometry", "ur_nodes.ports"),
    "ur_nodes.codecs.genpy": (),
    "ur_nodes.goal_topics": ("ur_nodes.ports",),
    "ur_nodes.ros2": (
        *("ur.source", "ur_nodes.geometry", "ur_nodes.file_facts", "ur_nodes.goal_topics"),
        *("ur_nodes.loop", "ur_nodes.node_base", "ur_nodes.ports", "ur_nodes.codecs"),
    ),
    "ur_nodes.memory_use": (),
    "ur_nodes.run": ("ur.source", "ur_nodes.ports", "ur_nodes.ros1"),
    "ur_nodes.motion": ("ur.source", "ur.robot.base", "ur_nodes.memory_use", "ur_nodes.ports", "ur_nodes.run"),
    "ur_nodes.frames": ("ur.source", "ur.robot.description", "ur_nodes.geometry", "ur_nodes.ports", "ur_nodes.run"),
    "ur_nodes.drivers": (
        "ur.source",
        "ur.devices.driver_health",
        "ur.robot.base",
        "ur.robot.robot_file",
        "ur.run.host.cgroup",
        "ur.run.host.descendants",
        "ur_nodes.geometry",
        "ur_nodes.motion.ramp",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.simulator.devices.plant",
    ),
    "ur_nodes.drivers.boards": (
        *("ur.source", "ur.robot.base", "ur_nodes.drivers.frames", "ur_nodes.drivers.lidars.turning_head"),
        *("ur_nodes.drivers.readings", "ur_nodes.simulator.devices.plant"),
    ),
    "ur_nodes.drivers.lidars": (
        "ur.source",
        "ur.robot.base",
        "ur_nodes.ports.values",
        "ur_nodes.drivers.frames",
        "ur_nodes.drivers.readings",
        "ur_nodes.simulator.devices.plant",
    ),
    "ur_nodes.simulator": (
        "ur.source",
        "ur.robot.base",
        "ur.worlds",
        "ur_nodes.geometry",
        "ur_nodes.memory_use",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.motion.ramp",
    ),
    "ur_nodes.simulator.devices": (
        "ur.source",
        "ur.robot.base",
        "ur_nodes.drivers.registry",
        "ur_nodes.geometry",
        "ur_nodes.simulator.mujoco_model",
        "ur_nodes.simulator.sensors",
        "ur_nodes.simulator.simulation",
    ),
    "ur_nodes.simulator.sensors": (
        "ur.source",
        "ur.robot.base",
        "ur.worlds",
        "ur_nodes.geometry",
        "ur_nodes.ports",
        "ur_nodes.simulator.mujoco_model",
        "ur_nodes.simulator.physics",
        "ur_nodes.simulator.scenery",
    ),
    "ur_nodes.mapping": (
        "ur.source",
        "ur.maps",
        "ur_nodes.geometry",
        "ur_nodes.memory_use",
        "ur_nodes.ports",
        "ur_nodes.run",
    ),
    "ur_nodes.localisation": (
        "ur.source",
        "ur_nodes.calibration_reports",
        "ur_nodes.geometry",
        "ur_nodes.memory_use",
        "ur_nodes.ports",
        "ur_nodes.run",
    ),
    "ur_nodes.slam": (
        "ur.source",
        "ur.maps",
        "ur_nodes.calibration_reports",
        "ur_nodes.geometry",
        "ur_nodes.ports",
        "ur_nodes.run",
    ),
    "ur_nodes.exploration": (
        "ur.source",
        "ur.maps",
        "ur.worlds",
        "ur_nodes.costmap",
        "ur_nodes.geometry",
        "ur_nodes.motion.lease",
        "ur_nodes.memory_use",
        "ur_nodes.ports",
        "ur_nodes.run",
    ),
    "ur_nodes.costmap": (
        "ur.source",
        "ur.robot.base",
        "ur.worlds",
        "ur_nodes.geometry",
        "ur_nodes.memory_use",
        "ur_nodes.ports",
        "ur_nodes.run",
    ),
    "ur_nodes.navigation": (
        "ur.source",
        "ur.robot.base",
        "ur_nodes.costmap",
        "ur_nodes.geometry",
        "ur_nodes.motion",
        "ur_nodes.memory_use",
        "ur_nodes.ports",
        "ur_nodes.run",
    ),
    "ur_nodes.navigation.planning": ("ur_nodes.costmap", "ur_nodes.geometry"),
    "ur_nodes.navigation.goals": ("ur_nodes.motion", "ur_nodes.memory_use", "ur_nodes.ports", "ur_nodes.run"),
    "ur_nodes.client": (
        "ur.source",
        "ur.maps",
        "ur_nodes.exploration.status",
        "ur_nodes.geometry",
        "ur_nodes.motion",
        "ur_nodes.navigation.goals",
        "ur_nodes.ports",
        "ur_nodes.run",
    ),
    "ur_nodes.calibration_reports": ("ur.source", "ur.devices.driver_health", "ur_nodes.geometry", "ur_nodes.ports"),
    "ur_nodes.datagram_socket": ("ur.recordings.datagrams", "ur_nodes.ports"),
    "ur_nodes.black_box": (
        *("ur.recordings", "ur.run.host.descendants", "ur.source"),
        *("ur_nodes.datagram_socket", "ur_nodes.memory_use", "ur_nodes.motion.lease", "ur_nodes.ports", "ur_nodes.run"),
    ),
    "ur_nodes.recorder": ("ur.recordings", "ur_nodes.black_box.black_box", "ur_nodes.ports", "ur_nodes.run"),
    "ur_nodes.replay": ("ur.recordings", "ur.source", "ur_nodes.datagram_socket", "ur_nodes.ports", "ur_nodes.run"),
    "ur_nodes.missions": (),
    "ur_nodes.missions.robot": (
        "ur.source",
        "ur_nodes.geometry",
        "ur_nodes.motion",
        "ur_nodes.navigation.goals",
        "ur_nodes.memory_use",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.client",
    ),
    "ur_nodes.teleop": (),
    "ur_nodes.teleop.terminal": ("ur.source", "ur.tui.screen", "ur_nodes.ports", "ur_nodes.run", "ur_nodes.client"),
    "ur_nodes.teleop.map_view": (
        "ur.source",
        "ur.tui.screen",
        "ur_nodes.geometry",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.client",
    ),
    "ur_nodes.teleop.navigate": (
        "ur.source",
        "ur.maps",
        "ur.tui.screen",
        "ur_nodes.geometry",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.teleop.map_view",
        "ur_nodes.client",
        "ur_nodes.teleop.terminal",
    ),
    "ur_nodes.teleop.keyboard": (
        "ur.source",
        "ur.maps",
        "ur_nodes.geometry",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.motion",
        "ur_nodes.teleop.map_view",
        "ur_nodes.client",
        "ur_nodes.teleop.terminal",
    ),
    "ur_nodes.teleop.explore": (
        "ur.source",
        "ur_nodes.exploration",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.teleop.map_view",
        "ur_nodes.client",
        "ur_nodes.teleop.terminal",
    ),
    "ur_nodes.teleop.camera": (
        "ur.source",
        "ur.tui.screen",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.pictures",
        "ur_nodes.teleop.terminal",
    ),
    "ur_nodes.web": (
        "ur.source",
        "ur.robot.base",
        "ur.robot.description",
        "ur.maps",
        "ur.web.wire",
        "ur_nodes.exploration.status",
        "ur_nodes.geometry",
        "ur_nodes.motion",
        "ur_nodes.navigation",
        "ur_nodes.pictures",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.client",
    ),
    "ur_nodes.assistant": (
        *("ur.source", "ur.mcp.grants", "ur.worlds", "ur_nodes.geometry", "ur_nodes.motion"),
        "ur_nodes.navigation.goals",
        *("ur_nodes.ports", "ur_nodes.run", "ur_nodes.client", "ur_nodes.web.server_link", "ur_nodes.exploration"),
    ),
    "ur_nodes.pictures": ("ur.source", "ur_nodes.ports", "ur_nodes.run"),
    "ur_nodes.camera": ("ur.source", "ur.devices", "ur_nodes.pictures", "ur_nodes.ports", "ur_nodes.run"),
    "ur_nodes.camera.calibration": (
        "ur.source",
        "ur_nodes.camera",
        "ur_nodes.pictures",
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.teleop.camera",
        "ur_nodes.teleop.terminal",
    ),
    "ur_nodes.motion.ramp": ("ur.robot.base",),
    "ur_nodes.motion.challenge": ("ur_nodes.ports",),
    "ur_nodes.motion.lease": ("ur.source", "ur_nodes.ports", "ur_nodes.motion.challenge"),
    "ur_nodes.motion.admission": (
        "ur.devices.driver_health",
        "ur_nodes.ports",
        "ur_nodes.motion.challenge",
        "ur_nodes.motion.lease",
        "ur_nodes.motion.mux_events",
        "ur_nodes.motion.velocity_kind",
        "ur_nodes.motion.writes",
    ),
    "ur_nodes.motion.obstacle_stop": (
        "ur.source",
        "ur.robot.base",
        "ur_nodes.geometry",
        "ur_nodes.ports",
        "ur_nodes.motion.mux_time",
        "ur_nodes.motion.writes",
    ),
    "ur_nodes.motion.joystick": (
        "ur_nodes.ports",
        "ur_nodes.run",
        "ur_nodes.motion.challenge",
        "ur_nodes.motion.lease",
    ),
    "ur_nodes.vision": ("ur.source", "ur_nodes.geometry", "ur_nodes.pictures", "ur_nodes.ports", "ur_nodes.run"),
    "ur_nodes": ("ur.source", "ur_nodes.run", "ur_nodes.ros1.repairs"),
}
ROS = {
    "actionlib", "actionlib_msgs", "genpy", "geometry_msgs", "map_msgs", "move_base_msgs", "nav_msgs", "rosgraph",
    "rosgraph_msgs", "roslaunch", "roslib", "rospy", "sensor_msgs", "std_msgs", "std_srvs", "tf2_msgs", "tf2_py",
    "tf2_ros", "visualization_msgs", "rclpy", "rcl_interfaces", "action_msgs", "builtin_interfaces",
}  # fmt: skip
_VERSIONED = re.compile(r"\b\w+_ros[12]\w*|\b(?:\w+\.)+ros[12]\b|\bros[12]_\w+")
BACKENDS = ("ur_nodes.ros1", "ur_nodes.ros2", "ur_nodes.codecs")


def module_of(path: str) -> str:
    return path.removesuffix(".py").replace("/", ".").removesuffix(".__init__")


def layer_of(module: str) -> str:
    return max((name for name in MAY_IMPORT if module == name or module.startswith(name + ".")), key=len)


def imports_of(facts: Facts, known: Set[str]) -> Iterator[str]:
    """Return the modules that a file imports; `known` tells modules from other names in packages."""
    for each in facts.imports:
        yield each.module
        yield from {f"{each.module}.{name}" for name in each.names} & known


@pytest.fixture(scope="package")
def imports(modules: Mapping[str, Facts]) -> dict[str, set[str]]:
    """The imports of each module of src."""
    known = {*map(module_of, modules)}
    return {module_of(path): {*imports_of(each, known)} for path, each in modules.items()}


def test_modules_import_only_from_layers_below(imports: dict[str, set[str]]) -> None:
    wrong = []
    for module, names in imports.items():
        own = layer_of(module)
        allowed = (own, *MAY_IMPORT[own])
        for name in names:
            if name.split(".")[0] in ("ur", "ur_nodes") and name not in ("ur", "ur_nodes"):
                below = any(name == layer or name.startswith(layer + ".") for layer in allowed)
                parent = any(layer.startswith(name + ".") for layer in allowed)
                if not (below or parent):
                    wrong.append(f"{module} imports {name}, expected only {', '.join(allowed)}")
    assert not wrong, "\n".join(wrong)


def test_readers_of_plans_do_not_ask_which_version_of_ros_they_are_for(modules: Mapping[str, Facts]) -> None:
    folders = ("check", "docs", "graph", "complete", "lsp", "tools/find", "tools/format", "launchfile/query")
    readers = [path for path in modules if path.startswith(tuple(f"ur/{each}/" for each in folders))]
    front_ends = ("ur.launchfile.ros2", "ur.launchfile.plan.load")
    assert readers
    assert {i.module for path in readers for i in modules[path].imports if i.module.startswith(front_ends)} == set()
    texts = {path: (ROOT / "src" / path).read_text(encoding="utf-8") for path in readers}
    assert {(path, name) for path, text in texts.items() for name in _VERSIONED.findall(text)} == set()


def test_imports_are_absolute(modules: Mapping[str, Facts]) -> None:
    assert {path for path, each in modules.items() if any(i.module.startswith(".") for i in each.imports)} == set()


def test_only_the_backends_import_ros(imports: dict[str, set[str]]) -> None:
    wrong = [
        f"{module} imports {', '.join(sorted(used))}, expected ROS only in {', '.join(BACKENDS)}"
        for module, names in imports.items()
        if not any(module == each or module.startswith(each + ".") for each in BACKENDS)
        and (used := {name.split(".")[0] for name in names} & ROS)
    ]
    assert not wrong, "\n".join(wrong)


def test_the_time_of_beams_is_known_to_the_feed_of_scans_alone() -> None:
    """All consumers get scans from it; beside it, the time of beams is only translated, and judged as a number."""
    reads, subscribes = re.compile(r"\.time_increment\b"), re.compile(r"subscribe\([^()]*\bScan,")
    texts = {path.relative_to(ROOT / "src"): path.read_text() for path in (ROOT / "src/ur_nodes").rglob("*.py")}
    found = {str(path) for path, text in texts.items() if reads.search(text) and "codecs" not in path.parts}
    assert found == {"ur_nodes/geometry/scan_time.py", "ur_nodes/ports/validation.py"}
    found = {str(path) for path, text in texts.items() if subscribes.search(text)}
    assert found == {"ur_nodes/ports/scan_feed.py", "ur_nodes/drivers/driver_adapter_node.py"}


def test_xml_rpc_is_read_by_the_reader_with_limits(imports: dict[str, set[str]]) -> None:
    unlimited = {module for module, used in imports.items() if {"xmlrpc", "xmlrpc.client"} & used}
    assert {each for each in unlimited if not each.startswith("ur_nodes.ros1.")} == set()  # rospy's own calls


def test_every_module_that_is_imported_exists(facts: Mapping[str, Facts], imports: dict[str, set[str]]) -> None:
    missing = {
        (path, name)
        for path, each in facts.items()
        for name in imports_of(each, imports.keys())
        if name.split(".")[0] in ("ur", "ur_nodes") and name not in imports
    }
    assert not missing


def test_every_module_belongs_to_a_named_layer(imports: dict[str, set[str]]) -> None:
    assert {layer_of(module) for module in imports} <= set(MAY_IMPORT)
