"""Nodes, programs and components: from what a launch file writes to the values of the plan."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import PurePosixPath
from typing import Any, cast

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.specs import (
    ACTIVATED,
    ActionKind,
    ActionSpec,
    NodeKind,
    NodeSpec,
    ParameterFile,
    ParameterValues,
    ParamSpec,
    ParamValue,
    RemapStep,
    TraceStep,
    Trigger,
)
from ur.launchfile.ros2.collector import Collector
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.findings import find_executable
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.nav2 import fill_file, read_sections
from ur.launchfile.ros2.parameters import ParameterSections, TypedList, read_value, read_values
from ur.launchfile.ros2.substitutions import is_wanted, perform, split_command
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span

_ENDS = ("Shutdown", "EmitEvent")
_NODE_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)


class Nodes(Collector):
    """Makes the nodes of the plan."""

    def __init__(self, context: Context, draft: Draft) -> None:
        super().__init__(context, draft)
        self._later: list[tuple[list[object], Trigger, Made | None, str, tuple[Span, ...]]] = []
        self._trigger: Trigger | None = None
        self._names: dict[str, Span] = {}
        self._literal: set[str] = set()  # containers whose names no argument changes
        self._components: list[tuple[NodeSpec, Span]] = []
        self._sections: dict[str, ParameterSections | None] = {}
        self._programs: set[tuple[str, str]] = set()
        self._made: dict[int, NodeSpec] = {}  # by the id of what made them, which `_kept` keeps
        self._kept: list[Made] = []
        self._numbers: dict[str, int] = {}  # nodes by name
        self._actions: list[ActionSpec] = []
        self._handlers: dict[int, int] = {}  # numbers of event handlers by ids, as above
        self._plain: tuple[dict[str, str] | None, tuple[dict[str, str], tuple[str, ...]]] = None, ({}, ())
        """The environment of the last node that changes none, and what `_changes_of` returns for it."""

    def _execute(self, made: Made) -> None:
        command = made.get("cmd")
        items = command if isinstance(command, (list, tuple)) else [command]
        words = tuple(self._text(item, made.span) for item in items)
        shell = self._flag(made, "shell")
        if shell:
            words = ("sh", "-c", " ".join(words))
        program = words[0] if words else ""
        name = self._text(made.get("name"), made.span) if made.get("name") is not None else program.rpartition("/")[2]
        self._add(made, self._spec(made, "program", name or "program", "/", "", program, words[1:])())

    def _node(self, made: Made) -> None:
        node = self._make_node(made)
        self._add(made, node)
        if node.kind == "container":
            self._load(made, node.full_name)

    def _make_node(self, made: Made) -> NodeSpec:
        package = self._text(made.get("package"), made.span) if made.get("package") is not None else ""
        executable = self._text(made.get("executable", ""), made.span)
        self._check_executable(package, executable, made)
        given = self._text(made.get("name"), made.span) if made.get("name") is not None else ""
        if given and "<" not in given and not _NODE_NAME.fullmatch(given):
            raise DescriptionProblem(
                f"the name of the node is '{given}', expected letters, digits and '_'", "bad-name", made.place("name"),
                "a namespace has its own argument", given,
            )  # fmt: skip
        written = self._text(made.get("namespace"), made.span) if made.get("namespace") is not None else None
        namespace = self._absolute(written, made.place("namespace")) or "/"
        name = given or executable.rpartition("/")[2].removesuffix(".py")
        is_container = made.kind == "ComposableNodeContainer" or executable.startswith("component_container")
        kind: NodeKind = "container" if is_container else "lifecycle" if made.kind == "LifecycleNode" else "node"
        words = self._words(made.get("arguments"), made)
        ros_words = self._words(made.get("ros_arguments"), made)
        if ros_words:
            words = (*words, "--ros-args", *ros_words)
        return self._spec(made, kind, name, namespace, package, executable, words)(
            is_named=bool(given),
            is_placed=written is not None or self._context.namespace is not None,
            remaps=(*self._context.remaps, *self._remaps(made)),
            sources=self._sources(made, "parameters", name),
        )

    def _when(self, entities: object, trigger: Trigger, target: Made | None = None) -> None:
        """Visit entities later, when all else has been: an event starts them, that of `target` if there is one."""
        listed = list(entities) if isinstance(entities, (list, tuple)) else [entities]
        self._later.append((listed, trigger, target, self._context.file, self._context.chain))

    def _prefix_of(self, made: Made, program: str) -> str | None:
        prefix, configurations = made.get("prefix"), self._context.configurations
        if prefix is not None:
            return self._text(prefix, made.span)
        common = configurations.get("launch-prefix")
        wanted = configurations.get("launch-prefix-filter", "")
        if not isinstance(common, str) or not re.match(str(wanted), program.rpartition("/")[2]):
            return None
        return common

    def _emulates_terminal(self, made: Made) -> bool:
        known = self._context.configurations.get("emulate_tty")  # which all processes follow
        if known is None:
            return self._flag(made, "emulate_tty")
        self._context.used.add("emulate_tty")
        return self._flag(Made(made.kind, {"emulate_tty": known}, made.span), "emulate_tty")

    def _changes_of(self, made: Made) -> tuple[dict[str, str], tuple[str, ...]]:
        """Return the variables that a node gets beside those of the start, and those that it does not get."""
        context = self._context
        start = context.world.environment
        if is_plain := "env" not in made.values and "additional_env" not in made.values:
            known, changed = self._plain
            if known == context.environment:
                return changed
        wanted: dict[str, str] = dict(context.environment)
        for keyword in ("env", "additional_env"):
            given: Any = made.get(keyword)
            if isinstance(given, Unknown):
                self._on_gap(given, context.chain)
            elif isinstance(given, Mapping):
                if keyword == "env":
                    wanted.clear()
                wanted |= {self._text(key, made.span): self._text(value, made.span) for key, value in given.items()}
        changes = {key: value for key, value in wanted.items() if start.get(key) != value}
        found = changes, tuple(sorted(key for key in start if key not in wanted))
        if is_plain:
            self._plain = wanted, found
        return found

    def _check_executable(self, package: str, name: str, made: Made) -> None:
        if (package, name) in self._programs or "<" in package + name or not package or not name:
            return
        self._programs.add((package, name))
        is_missing, near = find_executable(package, name, self._context)
        if is_missing:
            message = f"package '{package}' has no executable '{name}', expected one that its build installs"
            help_ = f"did you mean {near}?" if near else "install it: install(TARGETS ...), or console_scripts"
            self._warn(message, "missing-executable", made.place("executable"), help_, name)

    def _words(self, given: object, made: Made) -> tuple[str, ...]:
        if given is None:
            return ()
        if isinstance(given, str):
            return split_command(given, self._context.budget)
        items = given if isinstance(given, (list, tuple)) else [given]
        return tuple(self._text(item, made.place("arguments")) for item in items)

    def _remaps(self, made: Made) -> tuple[tuple[str, str], ...]:
        given = made.get("remappings") or ()
        if isinstance(given, Unknown):
            self._on_gap(given, self._context.chain)
            return ()
        found = []
        for pair in cast("Iterable[object]", given):
            if isinstance(pair, Unknown):
                self._on_gap(pair, self._context.chain)
            elif isinstance(pair, (list, tuple)) and len(pair) == 2:
                found.append((self._text(pair[0], made.span), self._text(pair[1], made.span)))
            else:
                raise DescriptionProblem(
                    "remappings has an item that is no pair, expected ('from', 'to')",
                    "launch-value",
                    made.place("remappings"),
                    "write remappings=[('from', 'to')]",
                )
        return tuple(found)

    def _spec(
        self, made: Made, kind: NodeKind, name: str, namespace: str, package: str, type_: str, words: tuple[str, ...]
    ) -> Callable[..., NodeSpec]:
        context = self._context
        context.budget.charge(10 * (len(context.environment) + len(context.remaps) + len(context.global_parameters)))
        respawn = self._flag(made, "respawn")
        delay = made.get("respawn_delay")
        seconds = self._text(delay, made.span) if delay is not None else "0"
        output = made.get("output", "log")
        shown = self._text(output, made.span) if not isinstance(output, dict) else " ".join(map(str, output.values()))
        changes, unset = self._changes_of(made)
        retries = made.get("respawn_max_retries")
        on_exit = made.get("on_exit")
        ends: list[Any] = list(on_exit) if isinstance(on_exit, (list, tuple)) else [on_exit] if on_exit else []
        required = any(
            isinstance(each, Made)
            and (
                each.kind == "Shutdown"
                or (each.kind == "EmitEvent" and getattr(each.get("event"), "kind", "") == "ShutdownEvent")
            )
            for each in ends
        )
        if others := [each for each in ends if isinstance(each, Made) and not (required and each.kind in _ENDS)]:
            self._when(others, Trigger("exit"), made)
        for unknown in (each for each in ends if isinstance(each, Unknown)):
            self._on_gap(replace(unknown, span=unknown.span or made.place("on_exit")), context.chain)
        return partial(
            NodeSpec,
            name=name,
            namespace=namespace.rstrip("/") + "/",
            package=package,
            type=type_,
            args=" ".join(words),
            machine=None,
            respawn=respawn,
            respawn_delay=float(seconds) if re.fullmatch(r"\d+(\.\d*)?", seconds) else 0.0,
            required=required,
            output="screen" if re.search(r"screen|both|tty", shown) else "log",
            cwd=self._text(made.get("cwd"), made.span) if made.get("cwd") is not None else None,
            launch_prefix=self._prefix_of(made, type_),
            remaps=(),
            env=tuple(sorted(changes.items())),
            origin=self._origin(made.span),
            kind=kind,
            words=words,
            trigger=self._trigger,
            unset=unset,
            emulates_terminal=self._emulates_terminal(made),
            retries=retries if isinstance(retries, int) and retries >= 0 else None,
        )

    def _act(self, made: Made, kind: ActionKind, text: str, node: str = "") -> None:
        action = ActionSpec(kind, text, self._origin(made.span), self._trigger, node, len(self._draft.nodes))
        self._actions.append(action)

    def _add(self, made: Made, node: NodeSpec) -> None:
        number = self._numbers[node.full_name] = self._numbers.get(node.full_name, 0) + 1
        node = node if number == 1 else node._replace(number=number)
        self._made[id(made)] = node
        self._kept.append(made)
        if node.is_named and node.kind != "program" and node.trigger is None and "<" not in node.full_name:
            first = self._names.setdefault(node.full_name, made.span)
            if first is not made.span:
                message = f"a second node is named {node.full_name}, expected names to differ"
                help_ = "rename one of them, or give one a namespace"
                self._warn(message, "duplicate-node", made.place("name"), help_, node.full_name)
        self._draft.nodes.append(node)
        if self._flag(made, "autostart"):
            self._act(made, "state", ACTIVATED, node.full_name)
        for old, new in node.remaps:
            self._trace(RemapStep(old, new, node.origin))
        if node.kind == "program":
            return
        for source in node.sources:
            params, full = self._draft.params, node.full_name
            values: Iterable[tuple[str, object]] = ()
            if isinstance(source, ParameterValues):
                values = source.values
            elif (sections := self._read_sections(source)) is not None:
                values = sections.matching(full)
            for name, given in values:
                value = list(given) if isinstance(given, TypedList) else given
                param = params[f"{full}/{name}"] = ParamSpec(f"{full}/{name}", cast("ParamValue", value), source.origin)
                self._trace(param)

    def _trace(self, step: TraceStep) -> None:
        if self._draft.trace is not None:
            self._draft.trace.append(step)

    def _read_sections(self, source: ParameterFile) -> ParameterSections | None:
        if source.path not in self._sections:
            try:
                self._sections[source.path] = read_sections(source.path, self._context, source.origin.span)
            except DescriptionProblem as problem:
                self._context.report(problem)
                self._sections[source.path] = None
        return self._sections[source.path]

    def _sources(
        self, made: Made, keyword: str, node: str, *, common: bool = True
    ) -> tuple[ParameterFile | ParameterValues, ...]:
        context = self._context
        shared = context.global_parameters if common else ()
        found = [cast("ParameterFile | ParameterValues", each) for each in shared]
        given = made.get(keyword) or ()
        if isinstance(given, Unknown):
            self._on_gap(given, context.chain)
            return tuple(found)
        if isinstance(given, str) or not isinstance(given, (list, tuple)):
            raise DescriptionProblem(
                f"parameters of {node} are no list, expected a list of files and dicts", "launch-value",
                made.place(keyword), "write parameters=[...]",
            )  # fmt: skip
        place = made.place(keyword)
        for item in given:
            source = self._source(item, place)
            if source is not None:
                found.append(source)
        return tuple(found)

    def _source(self, item: object, place: Span) -> ParameterFile | ParameterValues | None:
        context = self._context
        if isinstance(item, Unknown):
            self._on_gap(item, context.chain)
            return None
        if isinstance(item, Mapping):
            pairs = list(read_values(item, place, context))
            shown = tuple((name, self._show(v, place) if isinstance(v, Unknown) else v) for name, v in pairs)
            return ParameterValues(shown, self._origin(place))
        if isinstance(item, Made) and item.kind == "Parameter":
            name = self._text(item.get("name", ""), item.span)
            value = read_value(item.get("value"), name, item.span, context)
            known = self._show(value, place) if isinstance(value, Unknown) else value
            listed = TypedList(known) if isinstance(known, list) else known
            return ParameterValues(((name, listed),), self._origin(item.span), is_rule=True)
        filled = False
        if isinstance(item, Made) and item.kind == "ParameterFile":
            filled = self._flag(item, "allow_substs")
            place, item = item.place("param_file"), item.get("param_file")
            if isinstance(item, Unknown):
                self._on_gap(item, context.chain)
                return None
        if not isinstance(item, (str, Made, PurePosixPath, list, tuple)) and not hasattr(item, "perform"):
            raise DescriptionProblem("parameters has an item that is neither file nor dict", "launch-value", place)
        path = perform(item, context)
        if isinstance(path, Unknown):
            self._on_gap(replace(path, span=path.span or place), context.chain)
            return None
        span = item.span if isinstance(item, Made) else place
        if filled:
            text = fill_file(context.find_file(path), context, span)
            if isinstance(text, Unknown):
                self._on_gap(Unknown(text.reason, text.span or span), context.chain)
                return None
            path = text
        return self._parameter_file(path, span)

    def _parameter_file(self, path: str, span: Span) -> ParameterFile | None:
        context = self._context
        if path in context.rewritten or path in context.written:
            return ParameterFile(path, self._origin(span))
        known = context.find_file(path)
        if "<" in path or not path:
            return None
        if not context.is_file(known):
            found = Diagnostic(
                Severity.ERROR, f"{path}: no such file, expected a parameter file: the node starts without it",
                "missing-file", span, (), context.near_file(known), path,
            )  # fmt: skip
            self._draft.add_diagnostic(found, context.chain)
            return None
        self._check_installed(path, span)
        full = context.world.absolute(known)
        return ParameterFile(full, self._origin(span), "" if known != path else str(PurePosixPath(path)))

    def _load(self, made: Made, container: str) -> None:
        given = made.get("composable_node_descriptions") or ()
        if isinstance(given, Unknown):
            self._on_gap(given, self._context.chain)
            return
        for item in cast("Iterable[object]", given):
            if isinstance(item, Unknown):
                self._on_gap(item, self._context.chain)
                continue
            if not isinstance(item, Made):
                raise DescriptionProblem("an item is no ComposableNode, expected one", "launch-value", made.span)
            wanted = is_wanted(item.get("condition"), self._context)
            if isinstance(wanted, Unknown):
                self._on_gap(replace(wanted, span=wanted.span or item.span), self._context.chain)
            elif wanted:
                self._component(item, container)

    def _component(self, item: Made, container: str) -> None:
        package, plugin = self._text(item.get("package", ""), item.span), self._text(item.get("plugin", ""), item.span)
        given = self._text(item.get("name"), item.span) if item.get("name") is not None else ""
        written = self._text(item.get("namespace"), item.span) if item.get("namespace") is not None else None
        namespace = self._absolute(written, item.place("namespace")) or "/"
        name = given or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", plugin.rpartition("::")[2]).lower()
        make = self._spec(item, "component", name, namespace, package, plugin, ())
        node = make(
            container=container,
            is_named=bool(given),
            is_placed=written is not None or self._context.namespace is not None,
            remaps=(*self._context.remaps, *self._remaps(item)),
            extra=tuple(
                pair
                for source in self._sources(item, "extra_arguments", name, common=False)
                if isinstance(source, ParameterValues)
                for pair in source.values
            ),
            sources=self._sources(item, "parameters", name),
        )
        self._components.append((node, item.span))
        self._add(item, node)

    def _load_components(self, made: Made) -> None:
        target = made.get("target_container")
        if isinstance(target, Made) and target.kind == "ComposableNodeContainer":
            known = self._made.get(id(target))
            container = known.full_name if known is not None else ""
        else:
            text = self._text(target, made.place("target_container"))
            container = text if text.startswith("/") else f"/{text}"  # the scope's namespace is not added
            if isinstance(target, str):
                self._literal.add(container)
        self._load(made, container)
