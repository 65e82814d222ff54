"""The calls that load components and change states, as launch_ros makes them."""

import json
from typing import Any

from tests.launchfile.ros2.plans import ENVIRONMENT, FILES, PACKAGES, load_clean, python

from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.memory import MemoryWorld
from ur.run.process.described import plan_effects
from ur.run.process.steps import describe_steps
from ur.run.supervisor.state import EndPlanned, PrintPlanned, StartPlanned

YAML = """
/**: {ros__parameters: {rate: 5, mixed: [1, 2.5], deep: {x: true}}}
/r/deep/q: {ros__parameters: {rate: 6}}
other: {ros__parameters: {no: 1}}
"""
EVENTS = """
from launch.events import matches_action
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from lifecycle_msgs.msg import Transition
lc = LifecycleNode(package='demo', executable='lc', name='lc', namespace='')
def change(step):
    return EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(lc), transition_id=step))
"""


def steps(plan: Plan, files: dict[str, str] | None = None) -> tuple[dict[str, Any], Any]:
    """The calls by unit, and the triggers of states."""
    programs, awaited = describe_steps(plan, MemoryWorld({**FILES, **(files or {})}, PACKAGES, ENVIRONMENT))
    return {program.unit.name: json.loads((program.files or ())[0][1]) for program, _, _ in programs}, awaited


def test_components_of_a_container_are_loaded_one_after_the_other() -> None:
    files = {"/ws/q.yaml": YAML}
    body = python(
        "ComposableNodeContainer(package='c', executable='component_container', name='box', namespace='', "
        "composable_node_descriptions=[ComposableNode(package='p', plugin='p::Talker', name='talker', "
        "parameters=[{'a': 1, 'l': [1, 2], 's': ['x'], 'f': 0.5, 't': 'text', 'deep': {'b': False}}], "
        "remappings=[('x', 'y')], extra_arguments=[{'use_intra_process_comms': True}]), "
        "ComposableNode(package='p', plugin='p::Unnamed')])",
        "GroupAction([PushRosNamespace('r'), SetParameter('use_sim_time', True), SetRemap('/tf', 'tf'), "
        "LoadComposableNodes(target_container='/box', composable_node_descriptions=[ComposableNode(package='p', "
        "plugin='p::Q', name='q', namespace='deep', parameters=['/ws/q.yaml', {'n': 1}])])])",
    )
    found, _ = steps(load_clean(body, files=files), files)
    first, second, third = found["/box/load"]
    assert {call["service"] for call in found["/box/load"]} == {"/box/_container/load_node"}
    assert first["fields"] == {
        "package_name": "p",
        "plugin_name": "p::Talker",
        "node_name": "talker",
        "remap_rules": ["x:=y"],
        "parameters": [
            {"name": "a", "value": {"type": 2, "integer_value": 1}},
            {"name": "l", "value": {"type": 7, "integer_array_value": [1, 2]}},
            {"name": "s", "value": {"type": 9, "string_array_value": ["x"]}},
            {"name": "f", "value": {"type": 3, "double_value": 0.5}},
            {"name": "t", "value": {"type": 4, "string_value": "text"}},
            {"name": "deep.b", "value": {"type": 1, "bool_value": False}},
        ],
        "extra_arguments": [{"name": "use_intra_process_comms", "value": {"type": 1, "bool_value": True}}],
    }
    assert second["fields"]["plugin_name"] == "p::Unnamed"
    assert "node_name" not in second["fields"]
    assert third["fields"]["node_namespace"] == "/r/deep"
    assert third["fields"]["remap_rules"] == ["/tf:=tf"]
    values = [(each["name"], *each["value"].values()) for each in third["fields"]["parameters"]]
    assert values == [
        ("use_sim_time", 1, True),
        ("rate", 2, 6),
        ("mixed", 8, [1.0, 2.5]),
        ("deep.x", 1, True),
        ("n", 2, 1),
    ]


def test_state_is_changed_by_a_call_and_awaited_by_a_program() -> None:
    plan = load_clean(
        python(
            "lc",
            "RegisterEventHandler(OnStateTransition(target_lifecycle_node=lc, goal_state='inactive', "
            "entities=[LogInfo(msg='is inactive'), change(Transition.TRANSITION_ACTIVATE)]))",
            "change(Transition.TRANSITION_CONFIGURE)",
            before=EVENTS,
        )
    )
    found, awaited = steps(plan)
    assert found == {
        "/lc/change_state": [
            {"service": "/lc/change_state", "fields": {"transition": {"id": 1}}, "about": "transition 1"}
        ],
        "/lc/change_state-2": [
            {"service": "/lc/change_state", "fields": {"transition": {"id": 3}}, "about": "transition 3"}
        ],
        "/lc/await_inactive": [{"service": "/lc/get_state", "fields": {}, "until": "inactive"}],
    }
    programs, _ = describe_steps(plan, MemoryWorld(FILES, PACKAGES, ENVIRONMENT))
    effects = {each.effect: each.triggers for each in plan_effects(plan, plan.nodes, programs, awaited)}
    assert effects[StartPlanned("/lc/change_state")] == ()
    assert effects[StartPlanned("/lc/await_inactive")] == ()
    assert [each.node for each in effects[StartPlanned("/lc/change_state-2")]] == ["/lc/await_inactive"]
    assert [each.node for each in effects[PrintPlanned("is inactive")]] == ["/lc/await_inactive"]


def test_steps_of_several_states_are_one_program_for_each_node() -> None:
    found, _ = steps(
        load_clean(python("LifecycleTransition(lifecycle_node_names=['/a', '/b'], transition_ids=[1, 3])"))
    )
    assert {name: [call["fields"]["transition"]["id"] for call in calls] for name, calls in found.items()} == {
        "/a/change_state": [1, 3],
        "/b/change_state": [1, 3],
    }


def test_end_of_the_run_is_an_action_with_its_reason() -> None:
    plan = load_clean(python("TimerAction(period=2.0, actions=[EmitEvent(event=ShutdownEvent(reason='late'))])",
                             before="from launch.events import Shutdown as ShutdownEvent"))  # fmt: skip
    (effect,) = plan_effects(plan, plan.nodes)
    assert effect.effect == EndPlanned("late")
    assert [(each.kind, each.seconds) for each in effect.triggers] == [("timer", 2.0)]
