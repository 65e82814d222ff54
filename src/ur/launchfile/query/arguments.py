"""`--ros-args`: the arguments of a launch file, with their documentation."""

from collections.abc import Sequence
from typing import NamedTuple

from ur.launchfile.load import has_tree, load_plan
from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.names import initial_namespace, read_assignments
from ur.launchfile.plan.problems import NOT_GIVEN, TagRefused
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import ArgumentStep, TraceStep
from ur.launchfile.plan.tags.arguments import resolve_arg
from ur.launchfile.plan.tags.attributes import is_wanted
from ur.launchfile.syntax import Comment, Element, LaunchFile
from ur.launchfile.world.protocol import World
from ur.source.diagnostic import Severity, UserError, user_error_about
from ur.source.file import Span


class Interface(NamedTuple):
    """The topics, services and actions of a node."""

    publishes: tuple[str, ...] = ()
    subscribes: tuple[str, ...] = ()
    services: tuple[str, ...] = ()  # that it offers
    calls: tuple[str, ...] = ()  # services of other nodes
    actions: tuple[str, ...] = ()  # that it offers
    uses_actions: tuple[str, ...] = ()  # of other nodes


def make_interface(
    publishes: str = "", subscribes: str = "", services: str = "", calls: str = "", actions: str = "", uses: str = ""
) -> Interface:
    """Make an interface of names that are separated by blanks."""
    parts = (publishes, subscribes, services, calls, actions, uses)
    return Interface(*(tuple(part.split()) for part in parts))


class ArgumentSpec(NamedTuple):
    """An argument that may be given. `default` is None if it is required; `doc` is empty without a comment.

    `choices`: the values that it may have; empty for any.
    """

    name: str
    default: str | None
    doc: str
    span: Span
    choices: tuple[str, ...] = ()


def read_arguments(
    path: str, arguments: Sequence[str], world: World, parsed: dict[str, LaunchFile] | None = None
) -> tuple[ArgumentSpec, ...]:
    """Return the arguments of a launch file in document order, without those of fixed value.

    `arguments` decide which `if` and `unless` hold. Documentation is `doc=`, else the comment `<!--NAME: text-->` that
    follows. `parsed` is that of `load_plan`. Raises UserError when the file cannot be read or an argument cannot be
    resolved.
    """
    parsed = {} if parsed is None else parsed
    if not has_tree(path, world, parsed):
        return _read_traced(path, arguments, world, parsed)
    draft = Draft(world, parsed=parsed)
    try:
        tree = draft.parse(path)
        scope = Scope(initial_namespace(arguments, world.environment), path, read_assignments(arguments)[0])
    except (OSError, ValueError) as problem:
        raise user_error_about(path, f"{problem}, expected a launch file", rule="missing-file") from None
    if tree.launch is None:
        raise UserError(*tree.diagnostics)
    # The comment that follows an element, by the place of the element.
    following: dict[int, Comment] = {}
    for first, second in zip(tree.launch.children, tree.launch.children[1:], strict=False):
        if isinstance(first, Element) and isinstance(second, Comment):
            following[first.start] = second
    comments = following
    found: dict[str, ArgumentSpec] = {}
    for element in tree.launch.elements:
        if element.name != "arg":
            continue
        try:
            if is_wanted(element, draft, scope):
                found.update(_read_argument(element, draft, scope, comments))
        except TagRefused as refused:
            draft.refuse(refused, scope)
            raise UserError(*draft.diagnostics) from None
    return tuple(found.values())


def _read_traced(
    path: str, arguments: Sequence[str], world: World, parsed: dict[str, LaunchFile]
) -> tuple[ArgumentSpec, ...]:
    # What a file that is included declares can be given, too, unless its value is passed.
    trace: list[TraceStep] = []
    plan = load_plan([path], arguments, world, trace, parsed=parsed)
    found: dict[str, ArgumentSpec] = {}
    for step in trace:
        if isinstance(step, ArgumentStep) and not (step.handed_over and step.origin.includes):
            default = None if step.kind == "required" else step.written if step.value is None else step.value
            found.setdefault(step.name, ArgumentSpec(step.name, default, step.doc, step.origin.span, step.choices))
    errors = [each for each in plan.diagnostics if each.severity is Severity.ERROR and each.kind != NOT_GIVEN]
    if errors and not found:
        raise UserError(*errors)
    return tuple(found.values())


def format_arguments(arguments: Sequence[ArgumentSpec]) -> str:
    """Return the output of `roslaunch --ros-args`; unlike there, an empty default counts as optional."""
    if not arguments:
        return "No arguments.\n"
    lines = []
    ordered = sorted(arguments, key=lambda argument: argument.name)
    required = [argument for argument in ordered if argument.default is None]
    optional = [argument for argument in ordered if argument.default is not None]
    if required:
        lines.append("Required Arguments:")
        lines += [f"  {argument.name}: {_describe(argument)}" for argument in required]
    if optional:
        lines.append("Optional Arguments:")
        lines += [f'  {argument.name} (default "{argument.default}"): {_describe(argument)}' for argument in optional]
    return "\n".join(lines) + "\n"


def _describe(argument: ArgumentSpec) -> str:
    choices = f" (one of {', '.join(argument.choices)})" if argument.choices else ""
    return f"{argument.doc or 'undocumented'}{choices}"


def _read_argument(
    element: Element, draft: Draft, scope: Scope, comments: dict[int, Comment]
) -> dict[str, ArgumentSpec]:
    before = len(scope.declared)
    resolve_arg(element, draft, scope)
    if len(scope.declared) == before or element.attributes.get("value"):
        return {}
    name = next(reversed(scope.declared))
    default = element.attributes.get("default")
    if default is not None and "$" in default:
        given = scope.args.pop(name)
        shown = Scope(scope.namespace, scope.filename, scope.args)
        resolve_arg(element, draft, shown)
        default, scope.args[name] = shown.args[name], given
    doc = element.attributes.get("doc") or ""
    comment = comments.get(element.start)
    if not doc and comment is not None:
        title, colon, text = comment.text.partition(":")
        doc = " ".join(text.split()) if colon and title.strip() == name else ""
    return {name: ArgumentSpec(name, default, doc, element.value_span("name"))}
