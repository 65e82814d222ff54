"""A plan under construction: its collected parts, and the findings."""

from ur.launchfile.plan.names import parents_of
from ur.launchfile.plan.problems import TagRefused, refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import (
    IncludeSpec,
    MachineSpec,
    NodeSpec,
    Origin,
    ParamCommand,
    ParamSpec,
    Plan,
    TestSpec,
    TraceStep,
)
from ur.launchfile.plan.values.budget import PER_PARAMETER, Budget, TooLong
from ur.launchfile.syntax import Element, LaunchFile, parse_launch_file
from ur.launchfile.world.protocol import World
from ur.source.diagnostic import Diagnostic, Note, Severity
from ur.source.file import Span

MAX_DIAGNOSTICS = 100
MAX_INCLUDES = 20_000
MAX_PARAMS = 500_000
CORE_NODE = "/rosout"  # roslaunch reads roscore.xml first, so this name is taken


class TooMuch(Exception):  # noqa: N818 - ends resolving; reported already
    """A limit was exceeded, so that resolution stops."""


class Draft:
    """Collects the parts of a Plan while files are resolved. One draft corresponds to one call of roslaunch."""

    def __init__(
        self,
        world: World,
        trace: list[TraceStep] | None = None,
        trees: dict[str, LaunchFile] | None = None,
        *,
        follow: bool = True,
        budget: Budget | None = None,
        parsed: dict[str, LaunchFile] | None = None,
    ) -> None:
        self.world = world
        self.budget = budget or Budget()
        self.follow = follow  # False: included files are named and not entered
        self.trace = trace  # collects how values resulted, when a caller asks for it
        self.nodes: list[NodeSpec] = []
        self.tests: list[TestSpec] = []
        self.params: dict[str, ParamSpec] = {}
        self.clear_params: list[str] = []
        self.machines: dict[str, MachineSpec] = {}
        self.machine_secrets: dict[str, tuple[str | None, bool]] = {}  # password and assignable: compared, never kept
        self.files: dict[str, None] = {}
        self.commands: list[ParamCommand] = []
        self.programs: list[ParamSpec] = []
        self.diagnostics: list[Diagnostic] = []
        self.node_places: dict[str, tuple[Element, tuple[Span, ...]]] = {}
        self.machine_uses: list[tuple[str, Element, Scope]] = []
        self.reads_angles = False  # roslaunch knows deg() and rad() once it has seen its first <rosparam>
        self.includes: list[IncludeSpec] = []
        self.endless: set[str] = set()  # files that include themselves to no end, and are not entered again
        self._parsed: dict[str, LaunchFile] = {} if parsed is None else parsed
        self._trees = trees

    def origin(self, span: Span, scope: Scope) -> Origin:
        """Return the origin of an item."""
        return Origin(span, scope.chain)

    def warn(
        self,
        message: str,
        span: Span | None,
        scope: Scope | None,
        rule: str,
        help: str | None = None,
        notes: tuple[Note, ...] = (),
        subject: str = "",
        *,
        kind: str = "",
    ) -> None:
        """Report a construct that roslaunch accepts, although it is probably a mistake."""
        chain = scope.chain if scope else ()
        self.add_diagnostic(Diagnostic(Severity.WARNING, message, rule, span, notes, help, subject, kind), chain)

    def refuse(self, refused: TagRefused, scope: Scope | None) -> None:
        """Report the error for which a tag was refused."""
        if refused.diagnostic is not None:
            self.add_diagnostic(refused.diagnostic, scope.chain if scope else ())

    def add_diagnostic(self, found: Diagnostic, chain: tuple[Span, ...]) -> None:
        """Report a finding in a file that was included through `chain`. Raises TooMuch after the hundredth error."""
        if chain:
            # A file that includes itself goes through the same places again and again: each is named once.
            places = {(span.file.path, span.start): span for span in reversed(chain)}
            steps = tuple(Note("included from here", span) for span in list(places.values())[:20])
            found = found._replace(notes=found.notes + steps)
        alike = sum(known.severity is found.severity for known in self.diagnostics)
        if alike < MAX_DIAGNOSTICS and found not in self.diagnostics:
            self.diagnostics.append(found)
        if alike + 1 >= MAX_DIAGNOSTICS and found.severity is Severity.ERROR:
            raise TooMuch

    def parse(self, path: str) -> LaunchFile:
        """Return a launch file, which is read and parsed only once. Raises OSError."""
        known = self._parsed.get(path)
        if known is None:
            known = self._parsed[path] = self._parse(path)
        return known

    def _parse(self, path: str) -> LaunchFile:
        if self._trees is None:
            return parse_launch_file(path, self.world.read_bytes(path), self.world.read_bytes)
        path = self.world.absolute(path)
        known = self._trees.get(path)
        if known is None:
            known = self._trees[path] = parse_launch_file(path, self.world.read_bytes(path), self.world.read_bytes)
        return known

    def add_param(self, param: ParamSpec, scope: Scope) -> None:
        """Set a parameter; the last value is used, at the position of the first."""
        known = self.params
        try:
            self.budget.charge(PER_PARAMETER)
        except TooLong as problem:
            raise refuse(
                f"parameter {param.name} {problem}", param.origin.span, "too-many-params", "split the launch file"
            ) from None
        for parent in parents_of(param.name) if known else ():
            if parent in known:
                self.warn(
                    f"parameter {param.name} is set inside {parent}, which is a value, expected one of the two",
                    param.origin.span,
                    scope,
                    "param-conflict",
                    notes=(Note(f"{parent} is set here", self.params[parent].origin.span),),
                    subject=param.name,
                )
        known[param.name] = param
        if self.trace is not None:
            self.trace.append(param)
        if len(known) > MAX_PARAMS:
            raise refuse(f"more than {MAX_PARAMS:,} parameters", param.origin.span, "too-many-params")

    def add_node(self, node: NodeSpec, element: Element, scope: Scope) -> None:
        """Add a node. Raises TagRefused if its name is taken."""
        if node.name:
            name = node.full_name
            span = element.value_span("name")
            if name in self.node_places:
                first, chain = self.node_places[name]
                steps = tuple(Note("which is included from here", step) for step in reversed(chain[-5:]))
                raise refuse(
                    f"a second node is named {name}, expected names to differ",
                    span,
                    "duplicate-node",
                    'rename one of them, put one into a <group ns=...>, or use name="$(anon ...)"',
                    (Note(f"the first {name} is here", first.value_span("name")), *steps),
                    name,
                )
            if name == CORE_NODE:
                raise refuse(
                    f"a node is named {name}, expected another name: the ROS core starts one with this name",
                    span,
                    "duplicate-node",
                    "rename it, or put it into a <group ns=...>",
                )
            self.node_places[name] = (element, scope.chain)
        self.nodes.append(node)

    def finish(self) -> Plan:
        """Return the collected plan."""
        return Plan(
            nodes=tuple(self.nodes),
            tests=tuple(self.tests),
            params=tuple(self.params.values()),
            clear_params=tuple(self.clear_params),
            machines=tuple(self.machines.values()),
            files=tuple(self.files),
            diagnostics=tuple(self.diagnostics),
            commands=tuple(self.commands),
            programs=tuple(self.programs),
            includes=tuple(self.includes),
        )
