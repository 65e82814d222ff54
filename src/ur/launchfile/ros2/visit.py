"""A description, carried out: its entities are visited in order, as upstream's launch service does, and make a Plan.

What an event starts later (an end, a timer) is visited when all else has been, in the order of the file.
"""

import posixpath
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any, cast

from ur.launchfile.plan.draft import Draft, TooMuch
from ur.launchfile.plan.problems import TOLERATED
from ur.launchfile.plan.specs import IncludeSpec, ParameterValues, Plan
from ur.launchfile.plan.values.budget import TooLong
from ur.launchfile.ros2.collector import find_declared, find_written
from ur.launchfile.ros2.context import ANY_NAME, DEEPEST, MOST_INCLUDES, Context
from ur.launchfile.ros2.declarations import Declarations
from ur.launchfile.ros2.model import Description, DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.parameters import read_value
from ur.launchfile.ros2.substitutions import is_wanted, perform
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span
from ur.source.suggest import suggest

MOST_ROUNDS = 1_000  # of a loop
ReadFile = Callable[[str, Context], Description]


class Visitor(Declarations):
    """Visits the entities of launch files. `read` reads a launch file in any language; it raises OSError."""

    def __init__(self, context: Context, draft: Draft, read: ReadFile) -> None:
        super().__init__(context, draft)
        self._read = read

    def start(self, description: Description) -> None:
        """Visit the file that is started, then what events start."""
        self._visit_file(description)
        while self._later:
            entities, trigger, target, self._context.file, self._context.chain = self._later.pop(0)
            self._trigger = trigger if target is None else trigger._replace(node=self._key_of(target))
            self._visit_all(entities)
        self._trigger = None
        started = {node.full_name for node in self._draft.nodes}
        for node, span in self._components:
            if not self._gaps and node.container not in started and node.container in self._literal:
                self._literal.discard(node.container)
                message = f"component {node.full_name} is loaded by {node.container}, expected a container of this name"
                help_ = suggest(node.container, self._names) or "start a ComposableNodeContainer of this name"
                self._warn(message, "unknown-container", span, help_, node.container)

        self.report_lost()

    def finish(self) -> Plan:
        """Return the plan."""
        return self._draft.finish()._replace(
            gaps=tuple(self._gaps),
            launcher="ros2 launch",
            unused=self.find_unused(),
            declared=tuple(self._can_be_given),
            actions=tuple(self._actions),
            written=tuple(self._context.written.items()),
        )

    # -- entities

    def _visit_file(self, description: Description) -> None:
        for problem in description.problems:
            self._context.report(problem)
        for gap in description.gaps:
            self._on_gap(gap, self._context.chain)
        if description.launch is not None:
            self._visit_all(cast("list[object]", [description.launch]))

    def _visit_all(self, entities: object) -> None:
        if entities is None:
            return
        if isinstance(entities, (Made, Unknown)):
            entities = [entities]
        if not isinstance(entities, (list, tuple)):
            return
        for entity in entities:
            if isinstance(entity, (list, tuple)):
                span = next((each.span for each in entity if isinstance(each, Made)), None)
                message = "a list stands where an action is needed, expected its actions one by one"
                self._context.report(DescriptionProblem(message, "launch-value", span, "write *LIST, or add each item"))
                self._visit_all(entity)
            elif isinstance(entity, Unknown):
                self._on_gap(entity, self._context.chain)
            elif isinstance(entity, Made):
                try:
                    self._visit(entity)
                except DescriptionProblem as problem:
                    problem.span = problem.span or entity.span
                    self._context.report(problem)
                except (TooMuch, TooLong, RecursionError):
                    raise
                except Exception as problem:  # what Python raises for the values of the file
                    text = f"{type(problem).__name__}: {problem}".rstrip(": ")
                    self._on_gap(Unknown(f"{entity.kind} raises {text}", entity.span), self._context.chain)

    def _visit(self, made: Made) -> None:
        self._context.budget.charge(50)
        if made.kind == "LaunchDescription":
            self._visit_all(made.get("initial_entities", []))
            return
        wanted = is_wanted(made.get("condition"), self._context)
        if isinstance(wanted, Unknown):
            self._on_gap(wanted.then(f"whether {made.kind} takes part", made.span), self._context.chain)
            return
        if not wanted:
            self._check_condition(made)
            return
        method = _ACTIONS.get(made.kind, "")
        if not method:
            if made.kind not in _SILENT:
                message = f"{made.kind} stands where an action is needed"
                raise DescriptionProblem(message + ", expected an action", "launch-value", made.span, None, made.kind)
            return
        getattr(self, method)(made)

    def _set_configuration(self, made: Made) -> None:
        name = self._text(made.get("name", ""), made.span)
        self._context.configurations[name] = perform(made.get("value", ""), self._context)

    def _unset_configuration(self, made: Made) -> None:
        self._context.configurations.pop(self._text(made.get("name", ""), made.span), None)

    def _group(self, made: Made) -> None:
        context = self._context
        scoped = self._flag(made, "scoped", default=True)
        forwarding = self._flag(made, "forwarding", default=True)
        given: Any = made.get("launch_configurations") or {}
        if isinstance(given, Unknown):
            given = {ANY_NAME: replace(given, span=given.span or made.span)}
        values = {self._text(k): perform(v, context) for k, v in given.items()}
        if not scoped:
            context.configurations.update(values)
            self._visit_all(made.get("actions"))
            return
        context.push_scope()
        context.push_environment()
        if not forwarding:
            context.reset_scope()
            context.reset_environment()
        context.configurations.update(values)
        try:
            self._visit_all(made.get("actions"))
        finally:
            context.pop_environment()
            context.pop_scope()

    def _include(self, made: Made) -> None:
        context = self._context
        source = made.get("launch_description_source")
        if isinstance(source, Unknown):
            self._on_gap(source, context.chain)
            return
        if isinstance(source, Made) and source.kind == "LaunchDescription":
            self._visit_all(source)
            return
        location = source.get("location") if isinstance(source, Made) and source.kind.endswith("Source") else source
        span = source.place("location") if isinstance(source, Made) else made.place("launch_description_source")
        text = perform(location, context)
        if isinstance(text, Unknown):
            self._on_gap(text.then("what this include starts", span), context.chain)
            return
        path = context.world.absolute(context.find_file(text))
        passed = self._read_arguments(made, span)
        found = context.is_file(path)
        spec = IncludeSpec(
            path,
            found,
            self._origin(made.span),
            context.namespace or "/",
            tuple((k, v if isinstance(v, str) else "") for k, v in passed),
        )
        self._draft.includes.append(spec)
        if not found:
            raise DescriptionProblem(
                f"{path}: no such file, expected a launch file", "missing-file", span, context.near_file(path), path
            )
        if len(self._draft.includes) > MOST_INCLUDES or len(context.chain) >= DEEPEST:
            raise DescriptionProblem("files include one another too often", "include-cycle", span)
        self._check_installed(text, span)
        self._draft.files[path] = None
        outer_file, outer_chain = context.file, context.chain
        context.file, context.chain = path, (*outer_chain, made.span)
        try:
            description = self._read(path, context)
            self._check_passed(description, passed, made, span)
            self._visit_file(description)
        finally:
            context.file, context.chain = outer_file, outer_chain

    def _read_arguments(self, made: Made, span: Span) -> list[tuple[str, str | Unknown]]:
        given = made.get("launch_arguments") or ()
        if isinstance(given, Unknown):
            self._on_gap(given, self._context.chain)
            return []
        pairs: Iterable[Any] = given.items() if isinstance(given, Mapping) else cast("Any", given)
        found = []
        for pair in pairs:
            if isinstance(pair, Unknown):
                self._on_gap(pair, self._context.chain)
            elif isinstance(pair, (list, tuple)) and len(pair) == 2:
                name, value = self._text(pair[0], span), perform(pair[1], self._context)
                self._context.configurations[name] = value  # which those after it may use
                found.append((name, value))
            else:
                raise DescriptionProblem(
                    "launch_arguments has an item that is no pair, expected (name, value)", "launch-value",
                    made.place("launch_arguments"), "write {'name': value}.items()",
                )  # fmt: skip
        return found

    def _check_passed(
        self, description: Description, passed: list[tuple[str, str | Unknown]], made: Made, span: Span
    ) -> None:
        declared, complete = find_declared(description, self._context.budget)
        if not complete:
            return
        text = description.launch.span.file.text if description.launch is not None else ""
        for name, _ in passed:
            if name not in declared and not re.search(rf"(?<!\w){re.escape(name)}(?!\w)", text):
                known = ", ".join(sorted(declared)) or "none"
                place = find_written(name, made.place("launch_arguments"), span)
                outer = self._context.chain[:-1]
                message = f"argument '{name}' is passed, but {description.path} does not declare it"
                help_ = suggest(name, declared) or f"that file declares: {known}"
                found = Diagnostic(Severity.WARNING, message, "unknown-argument", place, (), help_, name, TOLERATED)
                self._draft.add_diagnostic(found, outer)

    def _opaque(self, made: Made) -> None:
        function: Any = made.get("function")
        if isinstance(function, Unknown) or not hasattr(function, "call"):
            reason = function.reason if isinstance(function, Unknown) else "its function is not followed while reading"
            self._on_gap(Unknown(reason, made.span), self._context.chain)
            return
        arguments: Any = made.get("args") or ()
        keywords: Any = made.get("kwargs") or {}
        if isinstance(arguments, Unknown) or isinstance(keywords, Unknown):
            self._on_gap(Unknown("the arguments of its function", made.span), self._context.chain)
            return
        try:
            result = function.call(self._context, tuple(arguments), keywords)
        except (DescriptionProblem, TooMuch):
            raise
        except Exception as problem:  # what Python raises for the values of the file
            result = Unknown(f"{function.name} raises {type(problem).__name__}: {problem}", made.span)
        self._visit_all(result)

    def _repeat(self, made: Made) -> None:
        function: Any = made.get("function")
        values = made.get("input_values") if made.kind == "ForEach" else made.get("length")
        text = perform(values, self._context)
        if isinstance(text, Unknown) or not hasattr(function, "run"):
            gap = text if isinstance(text, Unknown) else Unknown("its function is not followed while reading")
            self._on_gap(replace(gap, span=made.span), self._context.chain)
            return
        place = made.place("input_values" if made.kind == "ForEach" else "length")
        try:
            if made.kind == "ForLoop":
                rounds: list[Any] = list(range(min(int(text), MOST_ROUNDS)))
            else:
                rounds = [self._context.load_yaml(part) for part in text.strip("; ").split(";")]
        except ValueError:
            rounds = [None]
        for each in rounds:
            if made.kind == "ForEach" and isinstance(each, dict):
                self._visit_all(function.run([], {str(name): value for name, value in each.items()}))
            elif made.kind == "ForLoop" and each is not None:
                self._visit_all(function.run([each], {}))
            else:
                wanted = "maps of YAML between semicolons" if made.kind == "ForEach" else "a number"
                raise DescriptionProblem(f"the rounds are '{text}', expected {wanted}", "bad-choice", place, None, text)

    def _round(self, made: Made) -> None:
        outer = dict(self._context.variables)
        self._context.variables.update(cast("dict[str, object]", made.get("variables")))
        self._visit_all(made.get("actions"))
        self._context.variables.clear()
        self._context.variables.update(outer)

    # -- environment

    def _set_variable(self, made: Made) -> None:
        name, value = self._text(made.get("name", ""), made.span), self._text(made.get("value", ""), made.span)
        self._context.environment[name] = value

    def _append_variable(self, made: Made) -> None:
        name, value = self._text(made.get("name", ""), made.span), self._text(made.get("value", ""), made.span)
        separator = self._text(made.get("separator", ":"), made.span)
        known = self._context.environment.get(name)
        prepend = self._flag(made, "prepend")
        self._context.budget.charge(len(known or "") // 8)
        parts = [value] if not known else [value, known] if prepend else [known, value]
        self._context.environment[name] = separator.join(parts)

    def _unset_variable(self, made: Made) -> None:
        self._context.environment.pop(self._text(made.get("name", ""), made.span), None)

    def _replace_variables(self, made: Made) -> None:
        given: Any = made.get("environment") or {}
        if isinstance(given, Unknown):
            self._on_gap(given, self._context.chain)
            return
        values = {self._text(name, made.span): self._text(value, made.span) for name, value in given.items()}
        self._context.environment.clear()
        self._context.environment.update(values)

    def _set_log_folder(self, made: Made) -> None:
        environment = self._context.environment
        default = f"{dict.get(environment, 'HOME', '')}/.ros/log"
        known = dict.get(environment, "ROS_LOG_DIR") or default
        environment["ROS_LOG_DIR"] = posixpath.join(known, self._text(made.get("log_dir", ""), made.span))

    def _leave_out(self, made: Made) -> None:
        self._on_gap(Unknown(f"{made.kind} is not carried out", made.span), self._context.chain)

    # -- scopes of launch_ros

    def _push_namespace(self, made: Made) -> None:
        text = self._text(made.get("namespace", ""), made.span)
        self._context.namespace = self._absolute(text, made.place("namespace"))

    def _set_remap(self, made: Made) -> None:
        pair = (self._text(made.get("src", ""), made.span), self._text(made.get("dst", ""), made.span))
        self._context.budget.charge(len(self._context.remaps))
        self._context.remaps = (*self._context.remaps, pair)

    def _set_parameter(self, made: Made) -> None:
        name = "use_sim_time" if made.kind == "SetUseSimTime" else self._text(made.get("name", ""), made.span)
        value = read_value(made.get("value"), name, made.span, self._context)
        shown = self._show(value, made.span) if isinstance(value, Unknown) else value
        values = ParameterValues(((name, shown),), self._origin(made.span), is_global=True)
        self._context.budget.charge(len(self._context.global_parameters))
        self._context.global_parameters = (*self._context.global_parameters, values)

    def _set_parameter_file(self, made: Made) -> None:
        path = self._text(made.get("filename", ""), made.span)
        source = self._parameter_file(path, made.place("filename"))
        if source is not None:
            shared = source._replace(argument="")  # absolute for all nodes
            self._context.global_parameters = (*self._context.global_parameters, shared)

    def _push_configurations(self, _: Made) -> None:
        self._context.push_scope()

    def _pop_configurations(self, _: Made) -> None:
        self._context.pop_scope()

    def _push_environment(self, _: Made) -> None:
        self._context.push_environment()

    def _pop_environment(self, _: Made) -> None:
        self._context.pop_environment()

    def _reset_environment(self, _: Made) -> None:
        self._context.reset_environment()

    def _reset_configurations(self, made: Made) -> None:
        given: Any = made.get("launch_configurations") or {}
        values = {self._text(key): perform(value, self._context) for key, value in given.items()}
        self._context.reset_scope()
        self._context.configurations.update(values)


_SILENT = frozenset({"Action", "LogDebug"})
_ACTIONS: Mapping[str, str] = {
    "AppendEnvironmentVariable": "_append_variable",
    "ComposableNodeContainer": "_node",
    "DeclareLaunchArgument": "_declare",
    "EmitEvent": "_emit",
    "ExecuteLocal": "_leave_out",
    "ExecuteProcess": "_execute",
    "ForEach": "_repeat",
    "ForLoop": "_repeat",
    "GroupAction": "_group",
    "IncludeLaunchDescription": "_include",
    "LifecycleNode": "_node",
    "LifecycleTransition": "_transition",
    "Log": "_log",
    "LogError": "_log",
    "LogInfo": "_log",
    "LogWarning": "_log",
    "LoopRound": "_round",
    "LoadComposableNodes": "_load_components",
    "Node": "_node",
    "OpaqueCoroutine": "_leave_out",
    "OpaqueFunction": "_opaque",
    "PopEnvironment": "_pop_environment",
    "PopLaunchConfigurations": "_pop_configurations",
    "PushEnvironment": "_push_environment",
    "PushLaunchConfigurations": "_push_configurations",
    "PushRosNamespace": "_push_namespace",
    "RegisterEventHandler": "_register",
    "ReplaceEnvironmentVariables": "_replace_variables",
    "ResetEnvironment": "_reset_environment",
    "ResetLaunchConfigurations": "_reset_configurations",
    "RosTimer": "_timer",
    "SetEnvironmentVariable": "_set_variable",
    "SetLaunchConfiguration": "_set_configuration",
    "SetParameter": "_set_parameter",
    "SetParametersFromFile": "_set_parameter_file",
    "SetROSLogDir": "_set_log_folder",
    "SetRemap": "_set_remap",
    "SetUseSimTime": "_set_parameter",
    "Shutdown": "_shutdown",
    "TimerAction": "_timer",
    "UnregisterEventHandler": "_unregister",
    "UnsetEnvironmentVariable": "_unset_variable",
    "UnsetLaunchConfiguration": "_unset_configuration",
}
