"""`$(eval ...)`: the Python expressions that roslaunch evaluates, without Python's eval.

roslaunch hands the text to Python's `eval` after refusing double underscores. Everything that can harm is left out here
(files, imports, introspection, endless computing); what launch files compute with is the same, values and quirks
included: constants and functions of `math` win over arguments of the same name, and inside a comprehension only its own
variables and Python's built-in functions are known (before Python 3.12).
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, ItemsView, Iterable, Iterator, KeysView, Mapping
from typing import Any

from ur.launchfile.plan.problems import NOT_PYTHON, Refused
from ur.launchfile.plan.values import expression_functions as functions
from ur.launchfile.plan.values.budget import (
    COSTS,
    PER_FUNCTION,
    PER_STEP,
    Budget,
    ExpressionProblem,
    TooLong,
    divide_cost,
    hash_cost,
)
from ur.launchfile.plan.values.expression_formats import CONVERSIONS, format_value
from ur.launchfile.syntax.substitution import SubstitutionProblem
from ur.source.suggest import did_you_mean

__all__ = ["ExpressionProblem", "evaluate_expression"]

MAX_LENGTH = 20_000
_HASHED = (set, frozenset, dict, KeysView, ItemsView)
_INLINED_COMPREHENSIONS = sys.version_info >= (3, 12)  # from then on they see the names around them


def evaluate_expression(
    text: str,
    commands: Mapping[str, Callable[..., Any]],
    look_up: Callable[[str], Any],
    known: Iterable[str] = (),
    budget: Budget | None = None,
) -> str:
    """The value of an expression as a text. `commands` are `arg`, `env`, ...; `look_up` gives an argument's value.

    `look_up` raises KeyError for an unknown name; `known` are the names it knows, for suggestions. What is computed is
    taken from `budget`, one of its own unless the expressions of a whole file share one. Raises
    ExpressionProblem with the place in the text; what `commands` and `look_up` raise as Refused or SubstitutionProblem
    passes through.
    """
    if "__" in text:
        start = text.find("__")
        raise ExpressionProblem("'__' is not allowed", start, start + 2, "roslaunch refuses double underscores")
    if len(text) > MAX_LENGTH:
        raise ExpressionProblem(f"{len(text):,} characters, expected at most {MAX_LENGTH:,}")
    stripped = text.lstrip(" \t")
    shift = len(text) - len(stripped)
    try:
        tree = ast.parse(stripped, mode="eval")
    except SyntaxError as problem:
        start = min(max((problem.offset or 1) - 1, 0) + shift, max(len(text) - 1, 0))
        raise ExpressionProblem(f"not a Python expression: {problem.msg}", start, start + 1, kind=NOT_PYTHON) from None
    except (ValueError, RecursionError, MemoryError) as problem:
        message = f"not a Python expression: {problem or 'nested too deep'}"
        raise ExpressionProblem(message, kind=NOT_PYTHON) from None
    evaluator = _Evaluator(stripped, shift, commands, look_up, known, budget or Budget())
    evaluator.budget.begin()
    try:
        value = evaluator.visit(tree.body)
        evaluator.budget.weigh(value)
        return str(value)
    except (Refused, SubstitutionProblem):
        raise
    except ExpressionProblem as problem:
        if problem.end <= problem.start and evaluator.at is not None:
            raise evaluator.problem(str(problem), evaluator.at, problem.help) from None
        raise
    except (RecursionError, MemoryError):
        raise ExpressionProblem("nested too deep") from None
    except TooLong as problem:
        raise evaluator.problem(str(problem), evaluator.at or tree.body) from None
    except Exception as problem:  # whatever Python says about the user's expression
        raise evaluator.problem(f"{problem} ({type(problem).__name__})", evaluator.at or tree.body) from None


class _Evaluator:
    def __init__(
        self,
        text: str,
        shift: int,
        commands: Mapping[str, Callable[..., Any]],
        look_up: Callable[[str], Any],
        known: Iterable[str],
        budget: Budget,
    ) -> None:
        self.text = text
        self.shift = shift
        self.commands = commands
        self.look_up = look_up
        self.known = known
        self.budget = budget
        self.variables: list[dict[str, Any]] = []  # of comprehensions, innermost last
        self.inside = 0  # how many comprehensions hide the names around them
        self.at: ast.expr | None = None

    def problem(self, message: str, node: ast.expr, help_: str | None = None, subject: str = "") -> ExpressionProblem:
        def offset(column: int) -> int:
            return self.shift + len(self.text.encode()[:column].decode(errors="replace"))

        start, end = offset(node.col_offset), offset(node.end_col_offset or 0)
        return ExpressionProblem(message, start, end, help_, subject=subject)

    def visit(self, node: ast.expr) -> Any:
        method = getattr(self, f"visit_{type(node).__name__}", None)
        if method is None:
            raise self.problem(
                f"{_describe(node)} is not allowed, expected arithmetic, comparisons, texts, lists and function calls",
                node,
            )
        outer, self.at = self.at, node
        self.budget.spend(PER_STEP)
        value = method(node)
        self.at = outer
        return value

    def charged(self, name: str, function: Callable[..., Any], subject: Any = None) -> Callable[..., Any]:
        """A function, or a method of `subject`, that takes what it costs from the budget, whoever calls it."""
        extra = COSTS.get(name)
        self.budget.spend(PER_FUNCTION)

        def call(*arguments: Any, **keywords: Any) -> Any:
            self.budget.weigh(subject, arguments, keywords)
            if extra is not None:
                self.budget.spend(extra((subject, *arguments) if subject is not None else arguments, keywords))
            return self.made(function(*arguments, **keywords))

        return call

    def made(self, value: Any) -> Any:
        """A value that was computed, its size taken from the budget."""
        self.budget.spend(functions.size_of(value))
        return value

    def visit_Constant(self, node: ast.Constant) -> Any:  # noqa: N802
        return node.value

    def visit_Name(self, node: ast.Name) -> Any:  # noqa: N802
        name = node.id
        for variables in reversed(self.variables):
            if name in variables:
                return variables[name]
        if not self.inside:
            if name in self.commands:
                return self.commands[name]
            if name in functions.CONSTANTS:
                return functions.CONSTANTS[name]
            if name in functions.MATH:
                found = functions.MATH[name]
                return self.charged(name, found) if callable(found) else found
            try:
                return self.look_up(name)
            except KeyError:
                pass
        if name in functions.BUILTINS:
            found = functions.BUILTINS[name]
            return self.charged(name, found) if callable(found) else found
        if name in functions.FORBIDDEN:
            raise self.problem(
                f"'{name}' is not allowed: resolving a launch file only computes",
                node,
                "print the value with a program of your own: <param command=...>",
            )
        known = [*self.known, *self.commands, *functions.CONSTANTS, *functions.MATH, *functions.BUILTINS]
        near = did_you_mean(name, known)
        raise self.problem(
            f"'{name}' is not known, expected an argument or a function",
            node,
            f"did you mean {near}?" if near else f'declare it: <arg name="{name}" .../>, or quote it as a text',
            name,
        )

    def visit_UnaryOp(self, node: ast.UnaryOp) -> Any:  # noqa: N802
        return functions.UNARY[type(node.op)](self.visit(node.operand))

    def visit_BinOp(self, node: ast.BinOp) -> Any:  # noqa: N802
        left, right = self.visit(node.left), self.visit(node.right)
        self.at = node
        operation = functions.BINARY.get(type(node.op))
        if operation is None:
            raise self.problem(f"{_describe(node.op)} is not allowed", node)
        self.budget.weigh(left, right)
        if isinstance(node.op, (ast.Div, ast.FloorDiv, ast.Mod)):
            self.budget.spend(divide_cost(left, right))
        elif isinstance(left, _HASHED) and isinstance(right, _HASHED):
            self.budget.spend(hash_cost(len(left) + len(right)))
        return self.made(operation(left, right))

    def visit_BoolOp(self, node: ast.BoolOp) -> Any:  # noqa: N802
        value: Any = None
        for operand in node.values:
            value = self.visit(operand)
            if bool(value) == isinstance(node.op, ast.Or):
                break
        return value

    def visit_Compare(self, node: ast.Compare) -> Any:  # noqa: N802
        left = self.visit(node.left)
        value: Any = True
        for operator, operand in zip(node.ops, node.comparators, strict=True):
            right = self.visit(operand)
            self.at = node
            self.budget.weigh(left, right)
            if isinstance(left, _HASHED) and isinstance(right, _HASHED):
                self.budget.spend(hash_cost(len(left)))
            value = functions.COMPARE[type(operator)](left, right)
            if not value:
                break
            left = right
        return value

    def visit_IfExp(self, node: ast.IfExp) -> Any:  # noqa: N802
        return self.visit(node.body if self.visit(node.test) else node.orelse)

    def visit_List(self, node: ast.List) -> Any:  # noqa: N802
        return [self.visit(item) for item in node.elts]

    def visit_Tuple(self, node: ast.Tuple) -> Any:  # noqa: N802
        return tuple(self.visit(item) for item in node.elts)

    def visit_Set(self, node: ast.Set) -> Any:  # noqa: N802
        return self._collect(self.visit(item) for item in node.elts)

    def visit_Dict(self, node: ast.Dict) -> Any:  # noqa: N802
        if None in node.keys:
            raise self.problem("'**' is not allowed", node)
        pairs = zip(node.keys, node.values, strict=True)
        return self._map((self.visit(key), self.visit(value)) for key, value in pairs if key is not None)

    def visit_Subscript(self, node: ast.Subscript) -> Any:  # noqa: N802
        value = self.visit(node.value)
        index = self.visit(node.slice)
        self.at = node
        if not isinstance(value, (str, bytes, list, tuple, dict, range)):
            raise self.problem(f"a value of type {type(value).__name__} has no parts", node)
        if isinstance(value, dict):
            self.budget.weigh(index)
            self.budget.spend(len(value))
        return self.made(value[index])

    def visit_Slice(self, node: ast.Slice) -> Any:  # noqa: N802
        return slice(*(self.visit(part) if part is not None else None for part in (node.lower, node.upper, node.step)))

    def visit_JoinedStr(self, node: ast.JoinedStr) -> Any:  # noqa: N802
        return "".join(self.made(str(self.visit(part))) for part in node.values)

    def visit_FormattedValue(self, node: ast.FormattedValue) -> Any:  # noqa: N802
        value = self.visit(node.value)
        self.budget.weigh(value)
        if node.conversion != -1:
            value = CONVERSIONS[chr(node.conversion)](value)
        pattern = self.visit(node.format_spec) if node.format_spec else ""
        return format_value(value, pattern)

    def visit_Attribute(self, node: ast.Attribute) -> Any:  # noqa: N802
        value = self.visit(node.value)
        self.at = node
        found = functions.find_method(value, node.attr)
        return self.charged(node.attr, found, value) if callable(found) else found

    def visit_Call(self, node: ast.Call) -> Any:  # noqa: N802
        function = self.visit(node.func)
        arguments = [self.visit(argument) for argument in node.args]
        keywords = {}
        for keyword in node.keywords:
            if keyword.arg is None:
                raise self.problem("'**' is not allowed", node)
            keywords[keyword.arg] = self.visit(keyword.value)
        self.at = node
        return function(*arguments, **keywords)

    def visit_Lambda(self, node: ast.Lambda) -> Any:  # noqa: N802
        names = [argument.arg for argument in node.args.args]
        rest = (node.args.vararg, node.args.kwarg, *node.args.kwonlyargs, *node.args.posonlyargs, *node.args.defaults)
        if any(rest):
            raise self.problem("a lambda with more than plain arguments is not allowed", node)

        self.budget.spend(PER_FUNCTION)

        def call(*values: Any) -> Any:
            if len(values) != len(names):
                raise TypeError(f"lambda takes {len(names)} values, got {len(values)}")
            self.variables.append(dict(zip(names, values, strict=True)))
            self.inside += 1
            try:
                return self.visit(node.body)
            finally:
                self.inside -= 1
                self.variables.pop()

        return call

    def visit_ListComp(self, node: ast.ListComp) -> Any:  # noqa: N802
        return [self.visit(node.elt) for _ in self._loop(node.generators, inlined=True)]

    def visit_SetComp(self, node: ast.SetComp) -> Any:  # noqa: N802
        return self._collect(self.visit(node.elt) for _ in self._loop(node.generators, inlined=True))

    def visit_DictComp(self, node: ast.DictComp) -> Any:  # noqa: N802
        pairs = ((self.visit(node.key), self.visit(node.value)) for _ in self._loop(node.generators, inlined=True))
        return self._map(pairs)

    def visit_GeneratorExp(self, node: ast.GeneratorExp) -> Any:  # noqa: N802
        return iter([self.visit(node.elt) for _ in self._loop(node.generators, inlined=False)])

    def _collect(self, items: Iterable[Any]) -> set[Any]:
        found: set[Any] = set()
        for item in items:
            self.budget.weigh(item)
            self.budget.spend(len(found) // 16)  # as many may have the same hash
            found.add(item)
        return found

    def _map(self, pairs: Iterable[tuple[Any, Any]]) -> dict[Any, Any]:
        found: dict[Any, Any] = {}
        for key, value in pairs:
            self.budget.weigh(key)
            self.budget.spend(len(found) // 16)
            found[key] = value
        return found

    def _loop(self, generators: list[ast.comprehension], *, inlined: bool) -> Iterator[None]:
        first = self.visit(generators[0].iter)
        hides = not (inlined and _INLINED_COMPREHENSIONS)
        self.inside += hides
        self.variables.append({})
        try:
            yield from self._loop_over(generators, 0, first)
        finally:
            self.variables.pop()
            self.inside -= hides

    def _loop_over(self, generators: list[ast.comprehension], level: int, items: Any) -> Iterator[None]:
        generator = generators[level]
        for item in items:
            self.budget.spend(PER_STEP)
            self._assign(generator.target, item)
            if not all(self.visit(test) for test in generator.ifs):
                continue
            if level + 1 < len(generators):
                yield from self._loop_over(generators, level + 1, self.visit(generators[level + 1].iter))
            else:
                yield

    def _assign(self, target: ast.expr, value: Any) -> None:
        if isinstance(target, ast.Name):
            self.variables[-1][target.id] = value
        elif isinstance(target, (ast.Tuple, ast.List)):
            values = list(value)
            if len(values) != len(target.elts):
                raise self.problem(f"{len(values)} values, expected {len(target.elts)}", target)
            for part, item in zip(target.elts, values, strict=True):
                self._assign(part, item)
        else:
            raise self.problem(f"{_describe(target)} is not allowed here", target)


def _describe(node: ast.AST) -> str:
    return {"NamedExpr": "':='", "Starred": "'*'", "MatMult": "'@'", "Await": "await"}.get(
        type(node).__name__, type(node).__name__
    )
