"""Arguments as they are declared, with what is wrong about them and about the use of parameters."""

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.problems import NOT_GIVEN, TOLERATED
from ur.launchfile.plan.specs import ArgumentStep
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.events import Events
from ur.launchfile.ros2.findings import Found, find_impossible, find_lost_parameters, find_unused
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.substitutions import perform
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span
from ur.source.suggest import did_you_mean, suggest


class Declarations(Events):
    """Declares arguments, and reports what is certain when all has been visited."""

    def __init__(self, context: Context, draft: Draft) -> None:
        super().__init__(context, draft)
        self._declared: set[str] = set()
        self._given = frozenset(context.configurations)
        self._can_be_given: dict[str, None] = {}
        self._places: dict[tuple[str, str], Span] = {}  # of declarations without a condition, by file and name
        self._defaults: dict[Span, object] = {}  # of these declarations
        self._choices: dict[str, dict[str, list[str]]] = {}  # of arguments, by file and name

    @property
    def declared(self) -> frozenset[str]:
        """The arguments that the first file declares."""
        return frozenset(self._declared)

    def report_lost(self) -> None:
        """Report parameters that reach no node, and arguments that are not used."""
        for found in find_lost_parameters(self._draft.nodes, self._read_sections):
            self._add_found(found)

    def find_unused(self) -> tuple[Span, ...]:
        """Return the places of arguments of the first file that nothing can use."""
        first, *others = self._draft.files
        declared = {name: span for (path, name), span in self._places.items() if path == first}
        if self._gaps or self._draft.diagnostics or not set(declared) - self._context.used:
            return ()
        return tuple(find_unused(declared, self._context.used, [self._context.text_of(path) for path in others]))

    def _add_found(self, found: Found) -> None:
        made = Diagnostic(
            Severity.WARNING, found.message, found.rule, found.span, (), found.help, found.subject, TOLERATED
        )
        self._draft.add_diagnostic(made, found.chain)

    def _check_condition(self, made: Made) -> None:
        condition = made.get("condition")
        found = find_impossible(condition, self._choices.get(self._context.file, {}))
        if found is not None and isinstance(condition, Made):
            name, text = found
            known = self._choices[self._context.file][name]
            near = did_you_mean(text, known)
            help_ = f"did you mean '{near}'?" if near else f"its choices are {', '.join(known)}"
            message = f"the condition never holds: '{text}' is none of the choices of argument '{name}'"
            self._warn(message, "useless-condition", condition.span, help_, text)

    def _check_twice(self, name: str, made: Made) -> None:
        place = made.place("name")
        if made.get("condition") is None and place.file.path == self._context.file and not self._context.is_scoped:
            first = self._places.setdefault((self._context.file, name), place)
            if first.start != place.start and made.get("default_value") != self._defaults.get(first):
                message = f"argument '{name}' is declared a second time, expected it once: the first default is used"
                self._warn(message, "duplicate-arg", place, "remove one of them, or rename it", name)
            self._defaults[place] = made.get("default_value")

    def _declare(self, made: Made) -> None:
        context = self._context
        name = self._text(made.get("name", ""), made.span)
        if not context.chain:
            self._declared.add(name)
        handed_over = name in context.configurations
        if name in self._given or not (handed_over and context.chain):
            self._can_be_given[name] = None
        self._check_twice(name, made)
        if not handed_over:
            default = made.get("default_value")
            if default is None:
                context.configurations[name] = Unknown(f"argument '{name}' has no value", made.span, "argument")
                self._trace_argument(made, name, handed_over=False)
                message = f"argument '{name}' has no value, expected one: it has no default"
                raise DescriptionProblem(
                    message,
                    "missing-argument",
                    made.place("name"),
                    f"give it: {name}:=VALUE",
                    name,
                    "" if context.chain else NOT_GIVEN,
                )
            context.configurations[name] = perform(default, context)
        self._trace_argument(made, name, handed_over=handed_over)
        value, choices = context.configurations[name], made.get("choices")
        if isinstance(choices, (list, tuple)) and all(isinstance(each, str) for each in choices):
            self._choices.setdefault(context.file, {})[name] = [str(each) for each in choices]
        if isinstance(choices, (list, tuple)) and isinstance(value, str) and value not in choices:
            known = ", ".join(map(str, choices))
            message = f"argument '{name}' is '{value}', expected one of {known}"
            is_required = not value  # such a default is a habit: none of the choices is right for all
            if is_required:
                context.configurations[name] = Unknown(f"argument '{name}' has no value", made.span, "argument")
            place = made.place("choices" if handed_over else "default_value")
            help_ = suggest(value, [str(each) for each in choices]) or f"choose one of {known}"
            raise DescriptionProblem(message, "bad-choice", place, help_, name, NOT_GIVEN if is_required else "")

    def _trace_argument(self, made: Made, name: str, *, handed_over: bool) -> None:
        if self._draft.trace is None:
            return
        default, value, choices = made.get("default_value"), self._context.configurations[name], made.get("choices")
        doc = perform(made.get("description") or "", self._context)
        step = ArgumentStep(
            name,
            "required" if default is None else "default",
            default if isinstance(default, str) else " ".join(made.place("default_value").text.split()),
            value if isinstance(value, str) else None,
            self._origin(made.places.get("name", made.span)),
            handed_over=handed_over,
            doc=" ".join(doc.split()) if isinstance(doc, str) else "",
            choices=tuple(map(str, choices)) if isinstance(choices, (list, tuple)) else (),
        )
        self._draft.trace.append(step)
