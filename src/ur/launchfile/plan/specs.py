"""The resolved plan: the content of a launch file, every item with its origin."""

from typing import Literal, NamedTuple

from ur.source.diagnostic import Diagnostic
from ur.source.file import Span

ParamType = Literal["auto", "str", "int", "double", "bool", "yaml"]
ParamValue = bool | int | float | str | bytes | list["ParamValue"] | dict[str, "ParamValue"] | None


class Origin(NamedTuple):
    """The position of an item, and the `<include>` tags that led there, outermost first."""

    span: Span
    includes: tuple[Span, ...] = ()


class MachineSpec(NamedTuple):
    """A computer: roslaunch's `<machine>`."""

    name: str
    address: str
    user: str | None
    env_loader: str | None
    ssh_port: int
    timeout: float
    origin: Origin


class ParamSpec(NamedTuple):
    """A parameter with its full name. `command` is set instead of a value if a program prints the value."""

    name: str
    value: ParamValue
    origin: Origin
    command: str | None = None
    command_type: ParamType = "auto"


class ParamCommand(NamedTuple):
    """A `<rosparam command="dump">` or `"delete">`: an action on the parameter server before parameters are set.

    `file` is the target of a dump. `name` is the full name of the parameter or namespace.
    """

    command: Literal["dump", "delete"]
    name: str
    file: str | None
    origin: Origin


ReadyKind = Literal["topic", "service", "frame", "action", "process"]


class ReadyCondition(NamedTuple):
    """A readiness condition of a node: a published topic (at `rate` Hz), a service, a tf frame, an action.

    `name` is the full name on the master; that of a frame has no leading slash. "process" (without a name) means that
    the program is not a ROS node: it is ready when it runs.
    """

    kind: ReadyKind
    name: str
    rate: float | None = None


class ParameterFile(NamedTuple):
    """A file with parameters that a node is given. `argument` is its path as the node gets it, if that differs."""

    path: str
    origin: Origin
    argument: str = ""


class ParameterValues(NamedTuple):
    """Parameters that a node is given, in the order of the file.

    `is_global`: set for all nodes of a scope; `is_rule`: one by one, not as a file.
    """

    values: tuple[tuple[str, ParamValue], ...]
    origin: Origin
    is_global: bool = False
    is_rule: bool = False


class Trigger(NamedTuple):
    """The event that starts an item: `seconds` have passed, or a node has started, ended, printed, changed its state.

    `node` is the `key` of that node; empty for all nodes. `after` is the event from which on this one counts. Of a
    change of state, `states` are the state before and the state after it; either may be empty, for any.
    """

    kind: Literal["timer", "start", "exit", "output", "state", "shutdown"]
    node: str = ""
    seconds: float = 0.0
    after: "Trigger | None" = None
    states: tuple[str, str] = ("", "")
    handler: int = 0  # the number of the event handler, which an action may name


def describe_trigger(trigger: Trigger) -> str:
    """Return when an item starts: "when /driver ends"."""
    node = trigger.node or "a node"
    match trigger.kind:
        case "timer":
            return f"after {trigger.seconds:g} s"
        case "start":
            return f"when {node} has started"
        case "exit":
            return f"when {node} ends"
        case "output":
            return f"when {node} prints something"
        case "state":
            return f"when {node} changes its state"
        case "shutdown":
            return "when the run ends"


NodeKind = Literal["node", "lifecycle", "container", "component", "program"]


class NodeSpec(NamedTuple):
    """A node to start. `args` is one resolved string; the runner splits it as roslaunch does.

    A `component` is loaded by the node `container`, and its `type` is a class; a `program` is not a node of ROS. Nodes
    that are given parameters one by one have them in `sources`, where later ones win; `words` are their arguments.
    """

    name: str  # without namespace
    namespace: str  # with leading and trailing slash
    package: str
    type: str
    args: str
    machine: str | None
    respawn: bool
    respawn_delay: float
    required: bool
    output: Literal["log", "screen"]
    cwd: str | None
    launch_prefix: str | None
    remaps: tuple[tuple[str, str], ...]
    env: tuple[tuple[str, str], ...]
    origin: Origin
    terminal: bool = False  # a documentation comment `<!--terminal: ...-->` inside gives it the keyboard and screen
    ready: tuple[ReadyCondition, ...] = ()  # likewise `<!--ready: ...-->`: beyond being registered
    topics: tuple[tuple[str, str], ...] = ()  # likewise `<!--publishes: NAME ...-->`, `<!--subscribes: NAME ...-->`
    kind: NodeKind = "node"
    words: tuple[str, ...] = ()
    sources: tuple[ParameterFile | ParameterValues, ...] = ()
    container: str = ""
    trigger: Trigger | None = None
    is_named: bool = True  # False: the program chooses its name, and `name` is that of the program
    is_placed: bool = False  # the program is given the namespace, which may be "/"
    unset: tuple[str, ...] = ()  # variables that its environment does not have
    retries: int | None = None  # how often it is started again at most
    extra: tuple[tuple[str, ParamValue], ...] = ()  # arguments of a component
    number: int = 1  # among the nodes of the same name
    emulates_terminal: bool = False  # its output goes to a pseudo terminal, wherever it is shown

    @property
    def full_name(self) -> str:
        """The name with its namespace."""
        return self.namespace + self.name

    @property
    def key(self) -> str:
        """The full name; with a number for a second node of the same name."""
        return self.full_name if self.number == 1 else f"{self.full_name}-{self.number}"


ACTIVATED = "1 3"
"""The transitions that configure and activate a lifecycle node, by their numbers in lifecycle_msgs/Transition."""

ActionKind = Literal["log", "shutdown", "state", "unregister"]


class ActionSpec(NamedTuple):
    """Something that happens besides nodes: `text` is printed, the run ends, or the node `node` changes its state.

    `position` is the number of nodes of the plan before it. `text` is the reason of an end, a transition, or the number
    of an event handler that counts no longer.
    """

    kind: ActionKind
    text: str
    origin: Origin
    trigger: Trigger | None = None
    node: str = ""
    position: int = 0


class TestSpec(NamedTuple):
    """A `<test>`: a node and its time limits."""

    node: NodeSpec
    test_name: str
    time_limit: float
    retry: int


class IncludeSpec(NamedTuple):
    """An `<include>` that takes part; `origin` is the tag itself. `file` is absolute; `found`: it could be read.

    `namespace` is the initial one of the file, `arguments` those passed to it; `passes_all`: by `pass_all_args`.
    """

    file: str
    found: bool
    origin: Origin
    namespace: str
    arguments: tuple[tuple[str, str], ...]
    passes_all: bool = False


class ArgumentStep(NamedTuple):
    """The effect of one `<arg>`.

    `passed_to` is the `<include>` that contains it; without one it declares the argument. `written` is the text of
    `value=` or `default=`; `value` the argument's value after this tag, None without one. `handed_over`: an including
    file passed it. `doc` is its description, if that belongs to the language; `choices`: the values that it may have.
    """

    name: str
    kind: Literal["value", "default", "required"]
    written: str
    value: str | None
    origin: Origin
    handed_over: bool = False
    passed_to: Span | None = None
    doc: str = ""
    choices: tuple[str, ...] = ()


class RemapStep(NamedTuple):
    """A `<remap>` that takes part."""

    source: str
    target: str
    origin: Origin


class ValueStep(NamedTuple):
    """The text that a substitution or an expression has at its place."""

    value: str
    origin: Origin


LOCAL_ADDRESSES = frozenset({"localhost", "127.0.0.1", "::1"})
"""Addresses of machines that are this computer."""

TraceStep = ArgumentStep | RemapStep | ValueStep | ParamSpec
"""A parameter is traced each time it is set, also when a later one replaces it."""


GapKind = Literal["", "command", "argument", "package"]


class Gap(NamedTuple):
    """Something that reading a file does not find out. `reason` follows "is not known: " in messages.

    `kind` tells what the file is not responsible for: the output of a command, an argument that is not
    given, a package that is not installed.
    """

    reason: str
    origin: Origin | None = None
    kind: GapKind = ""


class Plan(NamedTuple):
    """Everything a launch file defines. Complete only if `diagnostics` has no error."""

    nodes: tuple[NodeSpec, ...]
    tests: tuple[TestSpec, ...]
    params: tuple[ParamSpec, ...]  # in the order in which roslaunch sets them; a name occurs once
    clear_params: tuple[str, ...]  # namespaces whose parameters go before any is set
    machines: tuple[MachineSpec, ...]
    files: tuple[str, ...]  # every launch file read, absolute
    diagnostics: tuple[Diagnostic, ...] = ()
    commands: tuple[ParamCommand, ...] = ()  # in document order
    programs: tuple[ParamSpec, ...] = ()  # every <param command=>, overridden ones too
    includes: tuple[IncludeSpec, ...] = ()  # in document order, each time one is included
    gaps: tuple[Gap, ...] = ()
    launcher: Literal["roslaunch", "ros2 launch", "other"] = "roslaunch"  # whose file it is
    unused: tuple[Span, ...] = ()  # names of arguments that nothing read so far can use
    environment: tuple[tuple[str, str], ...] = ()  # set for all that follows, beyond that of the start
    declared: tuple[str, ...] = ()  # arguments that can be given, of a file for ROS 2
    actions: tuple[ActionSpec, ...] = ()
    written: tuple[tuple[str, object], ...] = ()  # files that the launcher writes: paths, texts by `str`
    started: object = None  # of a plan that `ur docs` makes from those of single files: its file, with those below

    def all_nodes(self) -> tuple[NodeSpec, ...]:
        """Return the nodes, then those of the tests."""
        return (*self.nodes, *(test.node for test in self.tests))

    def is_local(self, node: NodeSpec) -> bool:
        """Return whether a node starts on this computer. A machine that is not defined counts as another one."""
        local = {machine.name for machine in self.machines if machine.address in LOCAL_ADDRESSES}
        return node.machine is None or node.machine in local
