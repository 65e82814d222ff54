"""Collection of texts of values, findings and gaps while a description is carried out."""

import re

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.problems import TOLERATED
from ur.launchfile.plan.specs import Gap, Origin, ValueStep
from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.model import Description, DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.substitutions import perform, perform_flag
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span

_NEAR = 4_000  # characters of the arguments of one include
_NAMESPACE = re.compile(r"/|(?:/[A-Za-z_]\w*)+", re.ASCII)


class Collector:
    """Collects findings of the files that are visited, in a draft of the plan."""

    def __init__(self, context: Context, draft: Draft) -> None:
        self._context, self._draft = context, draft
        self._gaps: dict[Gap, None] = {}
        context.on_problem, context.on_gap = self._on_problem, self._on_gap
        context.on_value = self._on_value if draft.trace is not None else None

    def _origin(self, span: Span) -> Origin:
        return Origin(span, self._context.chain)

    def _on_value(self, made: Made, text: str) -> None:
        if self._draft.trace is not None:
            end = max((place.end for place in made.places.values() if place.file is made.span.file), default=0)
            span = Span(made.span.file, made.span.start, max(end, made.span.end))
            self._draft.trace.append(ValueStep(text, self._origin(span)))

    def _on_problem(self, problem: DescriptionProblem, chain: tuple[Span, ...]) -> None:
        found = Diagnostic(
            # The rest of the plan is of use on a computer that does not have all packages.
            Severity.WARNING if problem.rule == "unknown-package" else Severity.ERROR,
            problem.message,
            problem.rule,
            problem.span,
            (),
            problem.help,
            problem.subject,
            problem.kind,
        )
        self._draft.add_diagnostic(found, chain)

    def _on_gap(self, unknown: Unknown, chain: tuple[Span, ...]) -> None:
        gap = Gap(unknown.reason, Origin(unknown.span, chain) if unknown.span is not None else None, unknown.kind)
        self._gaps[gap] = None

    def _warn(self, message: str, rule: str, span: Span, help_: str | None = None, subject: str = "") -> None:
        found = Diagnostic(Severity.WARNING, message, rule, span, (), help_, subject, TOLERATED)
        self._draft.add_diagnostic(found, self._context.chain)

    def _check_installed(self, path: str, span: Span) -> None:
        """Warn of a file that is in the source tree of its package only: it is missing once the package is built."""
        if self._context.is_left_out(path):
            message = f"{path} is not installed by its package, expected an install rule for this path"
            help_ = "add it to install(...) of CMakeLists.txt, or to data_files of setup.py"
            self._warn(message, "missing-file", span, help_, path)

    def _text(self, value: object, span: Span | None = None) -> str:
        """Return the text of a value; for one that is not known, its description in angle brackets."""
        text = perform(value, self._context) if type(value) is not str else value
        return text if isinstance(text, str) else self._show(text, span)

    def _show(self, unknown: Unknown, span: Span | None) -> str:
        self._on_gap(
            unknown if unknown.span is not None else Unknown(unknown.reason, span, unknown.kind), self._context.chain
        )
        return f"<{unknown.reason}>"

    def _flag(self, made: Made, name: str, *, default: bool = False) -> bool:
        """Return a flag; where it is not known, the default, and a gap."""
        flag = perform_flag(made.get(name, default), self._context, made, name)
        if isinstance(flag, Unknown):
            self._on_gap(flag.then(f"'{name}' of {made.kind}", made.place(name)), self._context.chain)
            return default
        return flag

    def _absolute(self, namespace: str | None, span: Span) -> str | None:
        """Return a namespace below that of the scope; None if neither is given."""
        joined = join_namespaces(self._context.namespace, namespace)
        if joined is None:
            return None
        if "<" not in joined and not _NAMESPACE.fullmatch(joined):
            raise DescriptionProblem(
                f"the namespace is '{joined}', expected letters, digits and '_' between slashes",
                "bad-name",
                span,
                None,
                joined,
            )
        return joined


def join_namespaces(base: str | None, name: str | None) -> str | None:
    """Return a namespace below another, absolute; None if neither is given. As launch_ros' `prefix_namespace`."""
    if base is None and name is None:
        return None
    joined = base if name is None else name if not base or name.startswith("/") else f"{base.rstrip('/')}/{name}"
    joined = joined or ""
    if joined != "/":
        joined = joined.rstrip("/")
    return joined if joined.startswith("/") else f"/{joined}"


def find_written(name: str, place: Span, other: Span) -> Span:
    """Return the span of a name between quotation marks, at or after a place; that of `other` if it is not there."""
    found = re.compile(f"(['\"]){re.escape(name)}\\1").search(place.file.text, place.start, place.start + _NEAR)
    return other if found is None else Span(place.file, found.start() + 1, found.end() - 1)


def find_declared(description: Description, budget: Budget) -> tuple[set[str], bool]:
    """Return the arguments that a file declares, and whether these are certain to be all."""
    found: set[str] = set()
    complete = description.launch is not None and not description.gaps
    waiting: list[object] = [description.launch]
    while waiting:
        entity = waiting.pop()
        budget.charge(1)
        if isinstance(entity, (list, tuple)):
            waiting.extend(entity)
        elif isinstance(entity, Unknown):
            complete = False
        elif isinstance(entity, Made):
            if entity.kind == "DeclareLaunchArgument":
                name = entity.get("name")
                found.add(str(name))
                complete = complete and isinstance(name, str)
            elif entity.kind in ("OpaqueFunction", "IncludeLaunchDescription", "ForEach", "ForLoop"):
                complete = False
            waiting.extend(entity.get(name) for name in ("initial_entities", "actions"))
    return found, complete
