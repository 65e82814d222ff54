"""The classes of `launch`, `launch_ros` and `nav2_common`: where they are imported from, and the arguments they accept.

Source: the signatures of launch 3.x and launch_ros 0.2x, from Jazzy to Rolling.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache


@dataclass(frozen=True, slots=True)
class Signature:
    """The arguments of a class: `positional` in their order, `keywords` are all, `required` those that it needs.

    `removed` are keywords of earlier releases, with the present ones.
    """

    kind: str
    positional: tuple[str, ...]
    keywords: frozenset[str]
    required: frozenset[str]
    removed: Mapping[str, str]


_CONDITION = "condition"
_LOCAL = (
    "shell sigterm_timeout sigkill_timeout emulate_tty output output_format cached_output log_cmd on_exit respawn "
    "respawn_delay respawn_max_retries condition"
)
_PROCESS = f"prefix cwd env additional_env {_LOCAL}"
_NODE = f"executable! package name namespace exec_name parameters remappings ros_arguments arguments {_PROCESS}"
_NAMED_NODE = _NODE.replace(" name ", " name! ").replace(" namespace ", " namespace! ")

# Module: class: positional arguments | keywords; `!` marks required ones.
_CLASSES = {
    "launch": {
        "LaunchDescription": "initial_entities deprecated_reason",
        "LaunchService": "|argv noninteractive debug",
        "LaunchContext": "|argv noninteractive",
        "LaunchDescriptionEntity": "",
        "LaunchDescriptionSource": "",
        "LaunchIntrospector": "",
        "SomeActionsType": "",
        "SomeEntitiesType": "",
        "Event": "",
        "Condition": "predicate",
        "SomeSubstitutionsType": "",
        "Substitution": "",
        "Action": f"|{_CONDITION}",
        "EventHandler": "|matcher! entities handle_once",
    },
    "launch.actions": {
        "AppendEnvironmentVariable": f"name! value! prepend separator | {_CONDITION}",
        "DeclareLaunchArgument": f"name! | default_value description choices {_CONDITION}",
        "EmitEvent": f"| event! {_CONDITION}",
        "ExecuteLocal": f"| process_description! {_LOCAL}",
        "ExecuteProcess": f"| cmd! name {_PROCESS}",
        "ForEach": f"input_values! | function! {_CONDITION}",
        "ForLoop": f"length! | function! name {_CONDITION}",
        "GroupAction": f"actions! | scoped forwarding launch_configurations {_CONDITION}",
        "IncludeLaunchDescription": f"launch_description_source! | launch_arguments {_CONDITION}",
        "Log": f"| msg! level! {_CONDITION}",
        "LogDebug": f"| msg! {_CONDITION}",
        "LogError": f"| msg! {_CONDITION}",
        "LogInfo": f"| msg! {_CONDITION}",
        "LogWarning": f"| msg! {_CONDITION}",
        "OpaqueCoroutine": f"| coroutine! args kwargs ignore_context {_CONDITION}",
        "OpaqueFunction": f"| function! args kwargs {_CONDITION}",
        "PopEnvironment": f"| {_CONDITION}",
        "PopLaunchConfigurations": f"| {_CONDITION}",
        "PushEnvironment": f"| {_CONDITION}",
        "PushLaunchConfigurations": f"| {_CONDITION}",
        "RegisterEventHandler": f"event_handler! | {_CONDITION}",
        "ReplaceEnvironmentVariables": f"environment | {_CONDITION}",
        "ResetEnvironment": f"| {_CONDITION}",
        "ResetLaunchConfigurations": f"launch_configurations | {_CONDITION}",
        "SetEnvironmentVariable": f"name! value! | {_CONDITION}",
        "SetLaunchConfiguration": f"name! value! | {_CONDITION}",
        "Shutdown": f"| reason {_CONDITION}",
        "TimerAction": f"| period! actions! cancel_on_shutdown {_CONDITION}",
        "UnregisterEventHandler": f"event_handler! | {_CONDITION}",
        "UnsetEnvironmentVariable": f"name! | {_CONDITION}",
        "UnsetLaunchConfiguration": f"name! | {_CONDITION}",
    },
    "launch.conditions": {
        "IfCondition": "predicate_expression!",
        "UnlessCondition": "predicate_expression!",
        "LaunchConfigurationEquals": "launch_configuration_name! expected_value!",
        "LaunchConfigurationNotEquals": "launch_configuration_name! expected_value!",
    },
    "launch.event_handlers": {
        "OnExecutionComplete": "| target_action on_completion! handle_once",
        "OnIncludeLaunchDescription": "| handle_once",
        "OnProcessExit": "| target_action on_exit! handle_once",
        "OnProcessIO": "| target_action on_stdin on_stdout on_stderr handle_once",
        "OnProcessStart": "| target_action on_start! handle_once",
        "OnShutdown": "| on_shutdown! handle_once",
    },
    "launch.events": {"Shutdown": "| reason due_to_sigint", "TimerEvent": "| timer_action!"},
    "launch.events.process": {
        "ProcessExited": "",
        "ProcessStarted": "",
        "ShutdownProcess": "| process_matcher!",
        "SignalProcess": "| signal_number! process_matcher!",
    },
    "launch.launch_description_sources": {
        "AnyLaunchDescriptionSource": "location!",
        "FrontendLaunchDescriptionSource": "location!",
        "PythonLaunchDescriptionSource": "location!",
        "XMLLaunchDescriptionSource": "location!",
        "YAMLLaunchDescriptionSource": "location!",
    },
    "launch.substitutions": {
        "AllSubstitution": "*conditions",
        "AndSubstitution": "left! right!",
        "AnonName": "name!",
        "AnySubstitution": "*conditions",
        "BooleanSubstitution": "value!",
        "Command": "command! | on_stderr",
        "EnvironmentVariable": "name! | default_value description",
        "EqualsSubstitution": "left! right!",
        "FileContent": "path!",
        "FindExecutable": "| name!",
        "ForEachVar": "name! | default_value",
        "ForLoopIndex": "name!",
        "IfElseSubstitution": "condition! if_value else_value",
        "LaunchConfiguration": "variable_name! | default",
        "LaunchLogDir": "",
        "LocalSubstitution": "expression! description",
        "NotEqualsSubstitution": "left! right!",
        "NotSubstitution": "value!",
        "OrSubstitution": "left! right!",
        "PathJoinSubstitution": "substitutions!",
        "PathSubstitution": "path!",
        "PythonExpression": "expression! python_modules",
        "StringJoinSubstitution": "substitutions! delimiter",
        "TextSubstitution": "| text!",
        "ThisLaunchFile": "",
        "ThisLaunchFileDir": "",
    },
    "launch_ros.actions": {
        "ComposableNodeContainer": f"| composable_node_descriptions {_NAMED_NODE}",
        "LifecycleNode": f"| autostart {_NAMED_NODE}",
        "LifecycleTransition": f"| lifecycle_node_names! transition_ids transition_labels {_CONDITION}",
        "LoadComposableNodes": f"| composable_node_descriptions! target_container! {_CONDITION}",
        "Node": f"| {_NODE}",
        "PushROSNamespace": f"namespace! | {_CONDITION}",
        "PushRosNamespace": f"namespace! | {_CONDITION}",
        "ROSTimer": f"| period! actions! cancel_on_shutdown {_CONDITION}",
        "RosTimer": f"| period! actions! cancel_on_shutdown {_CONDITION}",
        "SetParameter": f"name! value! | {_CONDITION}",
        "SetParametersFromFile": f"filename! node_name | {_CONDITION}",
        "SetROSLogDir": f"log_dir! | {_CONDITION}",
        "SetRemap": f"src! dst! | {_CONDITION}",
        "SetUseSimTime": f"value! | {_CONDITION}",
    },
    "launch_ros.descriptions": {
        "ComposableLifecycleNode": "| package! plugin! name! namespace autostart parameters remappings "
        "extra_arguments condition",
        "ComposableNode": "| package! plugin! name namespace parameters remappings extra_arguments condition",
        "Parameter": "name! value! | value_type",
        "ParameterFile": "param_file! | allow_substs",
        "ParameterValue": "value! | value_type",
    },
    "launch_ros.event_handlers": {
        "OnStateTransition": "| entities! target_lifecycle_node transition start_state goal_state handle_once"
    },
    "launch_ros.events.lifecycle": {"ChangeState": "| lifecycle_node_matcher! transition_id!"},
    "launch_ros.substitutions": {
        "ExecutableInPackage": "executable! package!",
        "FindPackage": "package!",
        "FindPackagePrefix": "package!",
        "FindPackageShare": "package!",
        "Parameter": "name! | default",
    },
    "nav2_common.launch": {
        "HasNodeParams": "source_file! node_name!",
        "LaunchConfigAsBool": "name!",
        "ParseMultiRobotPose": "target_argument!",
        "ReplaceString": "source_file! replacements! condition",
        "RewrittenYaml": "source_file! param_rewrites! root_key key_rewrites convert_types value_rewrites out_dir",
    },
}

# Names that are exported by more modules than the one above.
_ALSO = {
    "launch": (
        ("launch.launch_description", "LaunchDescription"),
        ("launch.launch_context", "LaunchContext"),
        ("launch.launch_service", "LaunchService"),
        ("launch.some_substitutions_type", "SomeSubstitutionsType"),
        ("launch.substitution", "Substitution"),
        ("launch.action", "Action"),
        ("launch.event_handler", "EventHandler"),
    ),
    "launch.launch_description_sources": (
        ("launch_xml.launch_description_sources", "XMLLaunchDescriptionSource"),
        ("launch_yaml.launch_description_sources", "YAMLLaunchDescriptionSource"),
        ("launch.launch_description_sources.python_launch_description_source", "PythonLaunchDescriptionSource"),
        ("launch.launch_description_sources.any_launch_description_source", "AnyLaunchDescriptionSource"),
    ),
    "launch_ros.descriptions": (
        ("launch_ros.parameter_descriptions", "Parameter"),
        ("launch_ros.parameter_descriptions", "ParameterFile"),
        ("launch_ros.parameter_descriptions", "ParameterValue"),
    ),
}
_REMOVED = {
    "node_executable": "executable",
    "node_name": "name",
    "node_namespace": "namespace",
    "node_plugin": "plugin",
}
_RENAMED = {"PushROSNamespace": "PushRosNamespace", "ROSTimer": "RosTimer"}
_EVENT_SHUTDOWN = "ShutdownEvent"  # launch.events.Shutdown; the action has the plain name


@cache
def modules() -> Mapping[str, Mapping[str, Signature]]:
    """Return the modules of the launch API with their classes."""
    found: dict[str, dict[str, Signature]] = {}
    for module, classes in _CLASSES.items():
        found[module] = {name: _read(_kind_of(module, name), text) for name, text in classes.items()}
    for module, names in _ALSO.items():
        for place, name in names:
            found.setdefault(place, {})[name] = found[module][name]
    for module, known in list(found.items()):
        for name, signature in known.items():  # modules of one class: launch.actions.timer_action
            if module.count(".") and module in _CLASSES:
                found.setdefault(f"{module}.{_snake(name)}", {})[name] = signature
    return found


@cache
def signatures() -> Mapping[str, Signature]:
    """Return the signatures by kind."""
    return {signature.kind: signature for classes in modules().values() for signature in classes.values()}


def describe_arguments(name: str) -> dict[str, tuple[bool, str]]:
    """Return the arguments of a class, by the name under which it is imported; see `ur.launchfile.load`."""
    found = next((modules()[module][name] for module in _CLASSES if name in modules()[module]), None)
    return {each: (each in found.required, _HELP.get(each, "")) for each in found.keywords} if found else {}


_HELP = {  # types and meanings of arguments, by name
    "additional_env": "dict: variables besides those of the launch",
    "arguments": "list: words of the command line",
    "autostart": "bool: configure and activate the node",
    "choices": "list: the values that it may have",
    "cmd": "list: the command line",
    "composable_node_descriptions": "list of ComposableNode",
    "condition": "IfCondition(...) or another condition",
    "cwd": "text: the working folder",
    "default_value": "text: without one, the argument is required",
    "description": "text: for --show-args",
    "emulate_tty": "bool: give it a terminal for its output",
    "env": "dict: all variables, in place of those of the launch",
    "executable": "text: the program of the package",
    "launch_arguments": "pairs: {'name': value}.items()",
    "name": "text: the node's name, in place of its own",
    "namespace": "text: relative to the pushed namespace",
    "on_exit": "actions for its end: Shutdown() ends the launch",
    "output": "'screen', 'log' or 'both'",
    "package": "text: the ROS package",
    "parameters": "list: files, and dicts of values",
    "plugin": "text: the class of the component",
    "prefix": "text: a command before the program",
    "remappings": "list of pairs: ('from', 'to')",
    "respawn": "bool: start it again after its end",
    "respawn_delay": "number: s before it is started again",
    "ros_arguments": "list: words after --ros-args",
    "shell": "bool: the command is one for the shell",
    "target_container": "text: the name of the container",
}


def _kind_of(module: str, name: str) -> str:
    if module == "launch.events" and name == "Shutdown":
        return _EVENT_SHUTDOWN
    if module == "launch_ros.substitutions" and name == "Parameter":
        return "ParameterSubstitution"
    return _RENAMED.get(name, name)


def _read(kind: str, text: str) -> Signature:
    before, bar, after = text.partition("|")
    first, rest = before.split(), after.split() if bar else []
    removed = _REMOVED if "executable!" in rest or "plugin!" in rest else {}
    return Signature(
        kind,
        tuple(word.rstrip("!") for word in first),
        frozenset(word.rstrip("!") for word in (*first, *rest)),
        frozenset(word[:-1] for word in (*first, *rest) if word.endswith("!")),
        removed,
    )


def _snake(name: str) -> str:
    text = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name)
    return text.lstrip("_")
