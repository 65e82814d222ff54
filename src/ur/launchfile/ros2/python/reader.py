"""Reader of Python launch files: from their text to a description, without running them.

Straight code, conditions, loops and the file's own functions are followed as long as their values are certain. A name
that depends on what is not certain is Unknown from there on. Nothing of the file is executed by Python.
"""

import ast
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from ur.launchfile.plan.values.budget import PER_STEP, TooLong
from ur.launchfile.plan.values.expression_functions import size_of
from ur.launchfile.ros2.context import MOST_BYTES, Context
from ur.launchfile.ros2.model import Description, DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.python.api_class import ApiClass
from ur.launchfile.ros2.python.expressions import Expressions, NotRead, builtin_exception
from ur.launchfile.ros2.python.imports import Imports
from ur.launchfile.ros2.python.modules import Library
from ur.launchfile.ros2.python.objects import (
    UNCERTAIN,
    ClassFunction,
    Frame,
    Function,
    Instance,
    Module,
    Opened,
    PropertyFunction,
    StaticFunction,
    UserClass,
    Written,
    bind,
)
from ur.launchfile.ros2.python.statements import (
    LoopEnd,
    Returned,
    assigned_names,
    assigns_names,
    decorator_name,
    extended_names,
    parse_text,
    reading_of,
    walk_here,
    word_of,
    written_attributes,
)
from ur.source.file import SourceFile, Span

ENTRY = "generate_launch_description"
_DEEPEST = 60  # calls
_MOST_LOOPS = 10_000
_NEUTRAL = frozenset({"cache", "lru_cache", "total_ordering", "expose_action", "expose_substitution"})
_PER_STATEMENT, _PER_CALL, _PER_GAP = 40, 200, 500  # units of work


def read_python(path: str, text: str, context: Context) -> Description:
    """Read a Python launch file. Never raises for its content."""
    source = SourceFile(path, text)
    try:
        tree = parse_text(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as problem:
        return Description(path, None, (_syntax_problem(source, problem),))
    reader = _Reader(source, context)
    return reader.read(tree)


def _syntax_problem(source: SourceFile, problem: BaseException) -> DescriptionProblem:
    line = getattr(problem, "lineno", None) or 1
    column = max((getattr(problem, "offset", None) or 1) - 1, 0)
    lines = source.text.count("\n") + 1
    start = min(source.offset_of_line(min(line, lines)) + column, len(source.text))
    reason = getattr(problem, "msg", None) or str(problem) or "nested too deep"
    return DescriptionProblem(
        f"not Python: {reason}",
        "python-syntax",
        Span(source, start, min(start + 1, len(source.text))),
        "correct this line",
    )


class _Reader(Imports):
    def __init__(self, source: SourceFile, context: Context) -> None:
        self._problems: list[DescriptionProblem] = []
        self._gaps: dict[Unknown, None] = {}
        self._library = Library(context, source.path)
        self._context, self._library.standard.text = context, source.text
        outermost = Frame(names={name: value for name, value in self._library.builtins().items() if value is not None})
        self._expressions = Expressions(source, context.budget, Frame(outermost))
        self._expressions.find_method = self._library.find_method
        self._expressions.call_function, self._expressions.report = self._call, self._report
        self._library.is_tried = lambda: self._expressions.tries > 0
        self._expressions.make_context = self._library.make_context
        self._library.standard.find_place = lambda: self._expressions.span(self._statement)
        self._statement: ast.AST = ast.Pass(lineno=1, col_offset=0, end_lineno=1, end_col_offset=0)
        self._depth = self._loops = self._tries_around = 0

    def read(self, tree: ast.Module) -> Description:
        path = self._expressions.source.path
        self._context.budget.begin()
        try:
            self._run(tree.body)
            found = self._expressions.frame.names_here.get(ENTRY)
            if not isinstance(found, Function):
                problem = self._no_entry(found)
                return Description(path, None, (*self._problems, *problem), tuple(self._gaps))
            try:
                launch = found.run([], {})
            except TypeError as problem:  # it has parameters
                span = self._expressions.span(found.node)
                if "launch_testing" in self._library.standard.text:
                    raise NotRead(f"a test calls {ENTRY}() with arguments", span) from None
                help_ = "ros2 launch calls it without arguments"
                raise DescriptionProblem(str(problem), "launch-function", span, help_, ENTRY) from None
            except (DescriptionProblem, TooLong, RecursionError, NotRead):
                raise
            except Exception as problem:  # what Python raises for the values of the file
                text = f"it raises {type(problem).__name__}: {problem}".rstrip(": ")
                raise NotRead(text, self._expressions.span(found.node)) from None
        except DescriptionProblem as problem:
            self._problems.append(problem)
            return Description(path, None, tuple(self._problems), tuple(self._gaps))
        except NotRead as problem:
            self._gaps[Unknown(problem.reason, problem.span)] = None
            return Description(path, None, tuple(self._problems), tuple(self._gaps))
        except (TooLong, RecursionError) as problem:
            self._gaps[Unknown(str(problem) or "it is nested too deep")] = None
            return Description(path, None, tuple(self._problems), tuple(self._gaps))
        finally:
            self._context.budget.end()
        if isinstance(launch, Unknown):
            self._gaps[launch] = None
        if isinstance(launch, Made) and launch.kind == "LaunchDescription":
            return Description(path, launch, tuple(self._problems), tuple(self._gaps))
        if not isinstance(launch, Unknown):
            span = self._expressions.span(found.node)
            self._problems.append(
                DescriptionProblem(f"{ENTRY}() returns no LaunchDescription", "launch-function", span, "return one")
            )
        return Description(path, None, tuple(self._problems), tuple(self._gaps))

    def _no_entry(self, found: object) -> tuple[DescriptionProblem, ...]:
        if isinstance(found, Unknown):
            self._gaps[found] = None
        if self._gaps:  # what is not followed may define it, or end the file
            return ()
        source = self._expressions.source
        return (
            DescriptionProblem(
                f"no function {ENTRY}(), expected one: ros2 launch calls it", "launch-function",
                Span(source, 0, min(len(source.text), 1)), f"define it: def {ENTRY}(): return LaunchDescription([...])",
            ),
        )  # fmt: skip

    def _report(self, problem: DescriptionProblem) -> None:
        if not any(known.span == problem.span and known.message == problem.message for known in self._problems):
            self._problems.append(problem)
        self._context.report(problem)

    def _gap(self, unknown: Unknown) -> None:
        self._gaps[unknown] = None
        self._context.add_gap(unknown)

    # -- statements

    def _run(self, body: Sequence[ast.stmt]) -> None:
        for statement in body:
            self._context.budget.spend(_PER_STATEMENT)
            self._statement = statement
            if isinstance(statement, (ast.Pass, ast.Global, ast.Nonlocal)):
                continue
            method = getattr(self, f"_run_{type(statement).__name__}", None)
            try:
                if method is None:
                    raise NotRead(
                        f"'{word_of(statement)}' is not followed while reading", self._expressions.span(statement)
                    )
                method(statement)
            except (Returned, LoopEnd, TooLong, RecursionError, DescriptionProblem):
                raise
            except NotRead as problem:
                if self._expressions.tries:  # it could have raised: nothing of the `try` is certain
                    raise
                self._give_up(statement, Unknown(problem.reason, problem.span))
            except Exception as problem:  # what Python raises for the values of the file
                if self._expressions.tries or (self._tries_around and hasattr(problem, "is_raised")):
                    raise
                at = self._expressions.at or statement
                text = f"{type(problem).__name__}: {problem}".rstrip(": ")
                self._give_up(statement, Unknown(f"it raises {text}", self._expressions.span(at)))

    def _give_up(self, statement: ast.stmt, unknown: Unknown) -> None:
        """Make all names Unknown that a statement assigns; a function that could return there returns Unknown."""
        self._context.budget.spend(_PER_GAP + PER_STEP * sum(1 for _ in walk_here(statement)))
        for name in assigned_names(statement):
            self._expressions.frame.names_here[name] = unknown
        for name in extended_names(statement):
            if isinstance(known := self._expressions.frame.names_here.get(name), list):
                known.append(unknown)
        for owner, attribute in written_attributes(statement):
            if isinstance(known := self._expressions.frame.names_here.get(owner), Instance):
                is_method = isinstance(known.of.members.get(attribute), Function)
                known.attributes[UNCERTAIN if is_method else attribute] = unknown
        if self._depth and isinstance(statement, ast.Raise | ast.Assert):
            self._gap(unknown)
            raise Returned(unknown)
        if any(isinstance(each, ast.Yield | ast.YieldFrom) for each in walk_here(statement)):
            self._expressions.yields.append(unknown)
        if any(isinstance(each, ast.Return) for each in walk_here(statement)):
            raise Returned(unknown)
        if not isinstance(statement, (ast.Import, ast.ImportFrom)) and not assigns_names(statement):
            self._gap(unknown)

    def _read_module(self, name: str, path: str) -> Module | None:
        try:
            text = self._context.read(path)[: MOST_BYTES + 1].decode(errors="replace")
            if len(text) > MOST_BYTES:
                return None
            tree = parse_text(text)
        except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
            return None
        reader = _Reader(SourceFile(path, text), self._context)
        with suppress(DescriptionProblem):
            reader._run(tree.body)
        return Module(name, reader._expressions.frame.names_here)

    def _run_FunctionDef(self, node: ast.FunctionDef) -> None:  # noqa: N802
        here = self._expressions
        defaults = tuple(here.visit(each) for each in node.args.defaults)
        named = {
            each.arg: here.visit(value)
            for each, value in zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
            if value is not None
        }
        function = Function(node.name, node, self._call, here.frame, defaults, named)
        value: object = function
        kinds = [decorator_name(each) for each in node.decorator_list]
        if kinds == ["staticmethod"]:
            value = StaticFunction(function)
        elif kinds == ["classmethod"]:
            value = ClassFunction(function)
        elif kinds == ["property"]:
            value = PropertyFunction(function)
        elif kinds == ["setter"] and isinstance(known := here.frame.names_here.get(node.name), PropertyFunction):
            value = PropertyFunction(known.function, function)
        elif not set(kinds) <= _NEUTRAL:
            value = Unknown(f"the decorated function {node.name} is not followed while reading", here.span(node))
        here.frame.names_here[node.name] = value

    def _run_ClassDef(self, node: ast.ClassDef) -> None:  # noqa: N802
        here = self._expressions
        kinds = {decorator_name(each) for each in node.decorator_list}
        if node.keywords or not kinds <= {"dataclass", *_NEUTRAL}:
            self._leave_out(node)
            return
        visited = [here.visit(base) for base in node.bases]
        bases = [base for base in visited if isinstance(base, UserClass)]
        api = [
            base if isinstance(base, ApiClass) else base.api
            for base in visited
            if isinstance(base, ApiClass | UserClass)
        ]
        inherited = {name: value for base in reversed(bases) for name, value in base.members.items()}
        outer, here.frame = here.frame, Frame(here.frame)
        try:
            self._run(node.body)
            members = here.frame.names_here
        finally:
            here.frame = outer
        fields = [field for base in reversed(bases) for field in base.fields]
        if "dataclass" in kinds or any(ast.unparse(base).endswith("NamedTuple") for base in node.bases):
            written = (each.target for each in node.body if isinstance(each, ast.AnnAssign))
            fields += [each.id for each in written if isinstance(each, ast.Name) and each.id not in fields]
        here.frame.names_here[node.name] = UserClass(
            node.name,
            {**inherited, **members},
            tuple(fields),
            next(filter(None, api), None),
            tuple(bases),
            self._exception_of(node, bases),
        )

    def _leave_out(self, node: ast.ClassDef | ast.AsyncFunctionDef) -> None:
        unknown = Unknown(f"{node.name} is not followed while reading", self._expressions.span(node))
        self._expressions.frame.names_here[node.name] = unknown

    _run_AsyncFunctionDef = _leave_out  # noqa: N815

    def _exception_of(self, node: ast.ClassDef, bases: list[UserClass]) -> type[Exception] | None:
        """Return what is raised with a class: a class of its name, below the exception that it is derived from."""
        known = [base.exception for base in bases if base.exception is not None]
        kinds = [*known, *(kind for base in node.bases if (kind := builtin_exception(base)) is not None)]
        self._context.budget.spend(_PER_GAP)
        return type(node.name, (kinds[0],), {}) if kinds else None

    def _call(self, function: Function, arguments: list[object], keywords: dict[str, object]) -> object:
        here = self._expressions
        self._context.budget.spend(_PER_CALL)
        if self._depth >= _DEEPEST:
            raise RecursionError("functions call one another too deep")
        bound = bind(function, arguments, keywords)
        outer, here.frame = here.frame, Frame(function.frame, bound)
        caller, here.function = here.function, function
        variables, yields, here.variables, here.yields = here.variables, here.yields, [], []
        loops, tries, self._loops, here.tries = self._loops, here.tries, 0, 0
        self._tries_around += tries
        self._depth += 1
        result: object = None
        try:
            if isinstance(function.node, ast.Lambda):
                return here.visit(function.node.body)
            self._run(function.node.body)
        except Returned as returned:
            result = returned.value
        finally:
            generated, here.yields = here.yields, yields
            here.frame, here.variables, here.function, here.tries = outer, variables, caller, tries
            self._depth, self._loops = self._depth - 1, loops
            self._tries_around -= tries
        is_known = here.yields_in(function.node) and not isinstance(result, Unknown)
        return iter(generated) if is_known else result  # all at once, as expressions are computed

    def _run_Return(self, node: ast.Return) -> None:  # noqa: N802
        if not self._depth:
            raise self._outside(node, "return", "a function")
        raise Returned(self._expressions.visit(node.value) if node.value is not None else None)

    def _run_Assign(self, node: ast.Assign) -> None:  # noqa: N802
        value = self._expressions.visit(node.value)
        for target in node.targets:
            self._assign(target, value)

    def _run_AnnAssign(self, node: ast.AnnAssign) -> None:  # noqa: N802
        if node.value is not None:
            self._assign(node.target, self._expressions.visit(node.value))

    def _run_AugAssign(self, node: ast.AugAssign) -> None:  # noqa: N802
        here = self._expressions
        load = reading_of(node.target)
        known, added = here.visit(load), node.value
        if isinstance(known, list) and isinstance(node.op, ast.Add):
            values = here.visit(added)
            self._context.budget.weigh(values)
            known.extend(values if isinstance(values, (list, tuple)) else [values])  # in place, as Python does
            size_of(known)
            return
        self._assign(node.target, here.visit(ast.copy_location(ast.BinOp(load, node.op, added), node)))

    def _assign(self, target: ast.expr, value: object) -> None:
        here = self._expressions
        if isinstance(target, ast.Name):
            here.frame.names_here[target.id] = value
        elif isinstance(target, (ast.Tuple, ast.List)):
            if isinstance(value, Unknown):
                for part in target.elts:
                    self._assign(part, value)
                return
            self._context.budget.weigh(value)
            values = list(value) if isinstance(value, (list, tuple, str, dict, range)) else []
            if len(values) != len(target.elts) or any(isinstance(part, ast.Starred) for part in target.elts):
                raise NotRead("this assignment is not followed while reading", here.span(target))
            for part, each in zip(target.elts, values, strict=True):
                self._assign(part, each)
        elif isinstance(target, ast.Subscript):
            container, index = here.visit(target.value), here.visit(target.slice)
            if isinstance(container, (dict, list)) and not isinstance(index, Unknown):
                if isinstance(index, slice):
                    self._context.budget.weigh(container, value)
                container[index] = value  # type: ignore[call-overload]
                size_of(container)
            elif not isinstance(container, Unknown):
                raise NotRead("this assignment is not followed while reading", here.span(target))
        elif isinstance(target, ast.Attribute) and isinstance(owner := here.visit(target.value), Instance):
            owner.assign(target.attr, value)
        else:
            raise NotRead("an attribute is assigned", here.span(target))

    def _run_Expr(self, node: ast.Expr) -> None:  # noqa: N802
        self._expressions.visit(node.value)

    def _run_If(self, node: ast.If) -> None:  # noqa: N802
        test = self._expressions.visit(node.test)
        if isinstance(test, Unknown):
            self._give_up(node, test)
        else:
            self._run(node.body if test else node.orelse)

    def _run_For(self, node: ast.For) -> None:  # noqa: N802
        values = self._expressions.visit(node.iter)
        if isinstance(values, Unknown):
            self._give_up(node, values)
            return
        self._context.budget.weigh(values)
        for value in list(values):  # type: ignore[call-overload]
            self._assign(node.target, value)
            if not self._run_round(node.body):
                return
        self._run(node.orelse)

    def _run_While(self, node: ast.While) -> None:  # noqa: N802
        for _ in range(_MOST_LOOPS):
            test = self._expressions.visit(node.test)
            if isinstance(test, Unknown):
                self._give_up(node, test)
                return
            if not test:
                return
            if not self._run_round(node.body):
                return
        raise NotRead("this loop does not end", self._expressions.span(node))

    def _run_round(self, body: Sequence[ast.stmt]) -> bool:
        """Run the statements of a loop once; return whether it goes on."""
        self._loops += 1
        try:
            self._run(body)
        except LoopEnd as end:
            return end.again
        finally:
            self._loops -= 1
        return True

    def _run_Break(self, node: ast.Break) -> None:  # noqa: N802
        raise LoopEnd(again=False) if self._loops else self._outside(node, "break", "a loop")

    def _run_Continue(self, node: ast.Continue) -> None:  # noqa: N802
        raise LoopEnd(again=True) if self._loops else self._outside(node, "continue", "a loop")

    def _outside(self, node: ast.stmt, word: str, place: str) -> DescriptionProblem:
        message = f"not Python: '{word}' outside of {place}"
        return DescriptionProblem(message, "python-syntax", self._expressions.span(node), "correct this line")

    def _run_With(self, node: ast.With) -> None:  # noqa: N802
        for item in node.items:
            value = self._expressions.visit(item.context_expr)
            if not isinstance(value, Opened | Written | Unknown):
                raise NotRead("'with' is followed for files only", self._expressions.span(node))
            if item.optional_vars is not None:
                self._assign(item.optional_vars, value)
        self._run(node.body)

    def _run_Try(self, node: ast.Try) -> None:  # noqa: N802
        self._expressions.tries += 1
        try:
            self._run(node.body)
        except (Returned, LoopEnd, TooLong, RecursionError, DescriptionProblem, NotRead):
            self._expressions.tries -= 1
            self._run(node.finalbody)
            raise
        except Exception as problem:
            self._expressions.tries -= 1
            self._handle(node, problem)
        else:
            self._expressions.tries -= 1
            self._run(node.orelse)
        self._run(node.finalbody)

    def _handle(self, node: ast.Try, problem: Exception) -> None:
        names = {each.__name__ for each in type(problem).__mro__}
        for handler in node.handlers:
            given = handler.type
            wanted = [] if given is None else given.elts if isinstance(given, ast.Tuple) else [given]
            known = {each.attr if isinstance(each, ast.Attribute) else getattr(each, "id", "") for each in wanted}
            if given is None or known & names:
                if handler.name:
                    self._expressions.frame.names_here[handler.name] = str(problem)
                self._run(handler.body)
                return
        raise problem

    def _run_Raise(self, node: ast.Raise) -> None:  # noqa: N802
        made = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
        kind = builtin_exception(made)
        if kind is None and made is not None and isinstance(known := self._expressions.visit(made), UserClass):
            kind = known.exception
        if kind is not None:
            arguments = node.exc.args if isinstance(node.exc, ast.Call) else []
            self._expressions.at = node.exc
            problem: Any = kind(*(self._expressions.visit(each) for each in arguments))
            problem.is_raised = True  # by the file: also a function that called this one may handle it
            raise problem
        words = ast.unparse(node.exc) if node.exc is not None else "an exception"
        raise NotRead(f"it raises {words}", self._expressions.span(node))

    def _run_Assert(self, node: ast.Assert) -> None:  # noqa: N802
        names = {each.id for each in walk_here(node) if isinstance(each, ast.Name)}
        if "isinstance" in names:  # which is not certain for all types
            return
        with suppress(NotRead):
            test = self._expressions.visit(node.test)
            if not test and not isinstance(test, Unknown):
                message = self._expressions.visit(node.msg) if node.msg is not None else ""
                problem: Any = AssertionError(message)
                problem.is_raised = True
                raise problem

    def _run_Delete(self, node: ast.Delete) -> None:  # noqa: N802
        for target in node.targets:
            if isinstance(target, ast.Name):
                self._expressions.frame.names_here.pop(target.id, None)
