"""`$(eval ...)`: the Python expressions that roslaunch evaluates, without Python's eval.

roslaunch passes the text to Python's `eval` after refusing double underscores. This evaluator omits everything harmful
(files, imports, introspection, endless computing); the features that launch files use are the same, including values
and quirks: constants and functions of `math` take precedence over arguments of the same name, and inside a
comprehension only its own variables and Python's built-in functions are known (before Python 3.12).
"""

import ast
import sys
from collections.abc import Callable, ItemsView, Iterable, Iterator, KeysView, Mapping
from typing import Any

from ur.launchfile.plan.problems import NOT_PYTHON, TagRefused
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
from ur.launchfile.plan.values.expression_functions import CONVERSIONS, format_value
from ur.launchfile.syntax.substitution import SubstitutionProblem
from ur.source.suggest import suggest

# ruff: noqa: N802 - methods have the names of the nodes of the syntax tree


_HASHED = (set, frozenset, dict, KeysView, ItemsView)


class Operations:
    """Evaluates an expression, apart from lambdas and comprehensions."""

    def __init__(
        self,
        text: str,
        shift: int,
        commands: Mapping[str, Callable[..., object]],
        look_up: Callable[[str], object],
        known: Iterable[str],
        budget: Budget,
    ) -> None:
        self.text = text
        self.shift = shift
        self.commands = commands
        self.look_up = look_up
        self.known = known
        self.budget = budget
        self.variables: list[dict[str, object]] = []  # of comprehensions, innermost last
        self.inside = 0  # how many comprehensions hide the names around them
        self.at: ast.expr | None = None

    def problem(self, message: str, node: ast.expr, help_: str | None = None, subject: str = "") -> ExpressionProblem:
        """Return a problem at the position of a node."""

        def offset(column: int) -> int:
            return self.shift + len(self.text.encode()[:column].decode(errors="replace"))

        start, end = offset(node.col_offset), offset(node.end_col_offset or 0)
        return ExpressionProblem(message, start, end, help_, subject=subject)

    def visit(self, node: ast.expr) -> object:
        """Return the value of a part of the expression."""
        method = getattr(self, f"visit_{type(node).__name__}", None)
        if method is None:
            raise self.problem(
                f"{describe(node)} is not allowed, expected arithmetic, comparisons, texts, lists and function calls",
                node,
            )
        outer, self.at = self.at, node
        self.budget.spend(PER_STEP)
        value = method(node)
        self.at = outer
        return value

    def charged(self, name: str, function: Callable[..., object], subject: object = None) -> Callable[..., object]:
        """Return a function, or a method of `subject`, whose calls are charged to the budget."""
        extra = COSTS.get(name)
        self.budget.spend(PER_FUNCTION)

        def call(*arguments: object, **keywords: object) -> object:
            self.budget.weigh(subject, arguments, keywords)
            if extra is not None:
                self.budget.spend(extra((subject, *arguments) if subject is not None else arguments, keywords))
            return self.made(function(*arguments, **keywords))

        return call

    def made(self, value: object) -> object:
        """Return a computed value after charging its size to the budget."""
        self.budget.spend(functions.size_of(value))
        return value

    def visit_Constant(self, node: ast.Constant) -> object:
        return node.value

    def visit_Name(self, node: ast.Name) -> object:
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
        raise self.problem(
            f"'{name}' is not known, expected an argument or a function",
            node,
            suggest(name, known) or f'declare it: <arg name="{name}" .../>, or quote it as a text',
            name,
        )

    def visit_UnaryOp(self, node: ast.UnaryOp) -> object:
        return functions.UNARY[type(node.op)](self.visit(node.operand))

    def visit_BinOp(self, node: ast.BinOp) -> object:
        left, right = self.visit(node.left), self.visit(node.right)
        self.at = node
        operation = functions.BINARY.get(type(node.op))
        if operation is None:
            raise self.problem(f"{describe(node.op)} is not allowed", node)
        self.budget.weigh(left, right)
        if isinstance(node.op, (ast.Div, ast.FloorDiv, ast.Mod)):
            self.budget.spend(divide_cost(left, right))
        elif isinstance(left, _HASHED) and isinstance(right, _HASHED):
            self.budget.spend(hash_cost(len(left) + len(right)))
        return self.made(operation(left, right))

    def visit_BoolOp(self, node: ast.BoolOp) -> object:
        value: object = None
        for operand in node.values:
            value = self.visit(operand)
            if bool(value) == isinstance(node.op, ast.Or):
                break
        return value

    def visit_Compare(self, node: ast.Compare) -> object:
        left = self.visit(node.left)
        value: object = True
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

    def visit_IfExp(self, node: ast.IfExp) -> object:
        return self.visit(node.body if self.visit(node.test) else node.orelse)

    def visit_List(self, node: ast.List) -> object:
        return [self.visit(item) for item in node.elts]

    def visit_Tuple(self, node: ast.Tuple) -> object:
        return tuple(self.visit(item) for item in node.elts)

    def visit_Set(self, node: ast.Set) -> object:
        return self.collect(self.visit(item) for item in node.elts)

    def visit_Dict(self, node: ast.Dict) -> object:
        if None in node.keys:
            raise self.problem("'**' is not allowed", node)
        pairs = zip(node.keys, node.values, strict=True)
        return self.map_pairs((self.visit(key), self.visit(value)) for key, value in pairs if key is not None)

    def visit_Subscript(self, node: ast.Subscript) -> object:
        value = self.visit(node.value)
        index: Any = self.visit(node.slice)
        self.at = node
        if not isinstance(value, (str, bytes, list, tuple, dict, range)):
            raise self.problem(f"a value of type {type(value).__name__} has no parts", node)
        if isinstance(value, dict):
            self.budget.weigh(index)
            self.budget.spend(len(value))
        return self.made(value[index])

    def visit_Slice(self, node: ast.Slice) -> object:
        return slice(*(self.visit(part) if part is not None else None for part in (node.lower, node.upper, node.step)))

    def visit_JoinedStr(self, node: ast.JoinedStr) -> object:
        return "".join(str(self.made(str(self.visit(part)))) for part in node.values)

    def visit_FormattedValue(self, node: ast.FormattedValue) -> object:
        value = self.visit(node.value)
        self.budget.weigh(value)
        if node.conversion != -1:
            value = CONVERSIONS[chr(node.conversion)](value)
        pattern = str(self.visit(node.format_spec)) if node.format_spec else ""
        return format_value(value, pattern)

    def visit_Attribute(self, node: ast.Attribute) -> object:
        value = self.visit(node.value)
        self.at = node
        found = functions.find_method(value, node.attr)
        return self.charged(node.attr, found, value) if callable(found) else found

    def visit_Call(self, node: ast.Call) -> object:
        function: Any = self.visit(node.func)
        arguments = [self.visit(argument) for argument in node.args]
        keywords = {}
        for keyword in node.keywords:
            if keyword.arg is None:
                raise self.problem("'**' is not allowed", node)
            keywords[keyword.arg] = self.visit(keyword.value)
        self.at = node
        return function(*arguments, **keywords)

    def collect(self, items: Iterable[object]) -> set[object]:
        """Return a set of values, charged as if all had the same hash."""
        found: set[object] = set()
        for item in items:
            self.budget.weigh(item)
            self.budget.spend(len(found) // 16)  # as many may have the same hash
            found.add(item)
        return found

    def map_pairs(self, pairs: Iterable[tuple[object, object]]) -> dict[object, object]:
        """Return a dict, charged in the same way."""
        found: dict[object, object] = {}
        for key, value in pairs:
            self.budget.weigh(key)
            self.budget.spend(len(found) // 16)
            found[key] = value
        return found


def describe(node: ast.AST) -> str:
    """Name a part of an expression in messages."""
    return {"NamedExpr": "':='", "Starred": "'*'", "MatMult": "'@'", "Await": "await"}.get(
        type(node).__name__, type(node).__name__
    )


__all__ = ["ExpressionProblem", "evaluate_expression"]

MAX_LENGTH = 20_000
_INLINED_COMPREHENSIONS = sys.version_info >= (3, 12)  # from then on they see the names around them


def evaluate_expression(
    text: str,
    commands: Mapping[str, Callable[..., object]],
    look_up: Callable[[str], object],
    known: Iterable[str] = (),
    budget: Budget | None = None,
) -> str:
    """Return the value of an expression as a text.

    `commands` are `arg`, `env`, ...; `look_up` returns an argument's value.

    `look_up` raises KeyError for an unknown name; `known` are the names it knows, for suggestions. The computation is
    charged to `budget`, a new one unless all expressions of a file share one. Raises ExpressionProblem with the
    position in the text; a TagRefused or SubstitutionProblem of `commands` and `look_up` passes through.
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
        raise ExpressionProblem(f"not a Python expression: {problem or 'nested too deep'}", kind=NOT_PYTHON) from None
    evaluator = Evaluator(stripped, shift, commands, look_up, known, budget or Budget())
    evaluator.budget.begin()
    try:
        value = evaluator.visit(tree.body)
        evaluator.budget.weigh(value)
        return str(value)
    except (TagRefused, SubstitutionProblem):
        raise
    except ExpressionProblem as problem:
        if problem.end <= problem.start and evaluator.at is not None:
            raise evaluator.problem(str(problem), evaluator.at, problem.help) from None
        raise
    except (RecursionError, MemoryError):
        raise ExpressionProblem("nested too deep") from None
    except TooLong as problem:
        raise evaluator.problem(str(problem), evaluator.at or tree.body) from None
    except Exception as problem:  # any warning of Python about the user's expression
        raise evaluator.problem(f"{problem} ({type(problem).__name__})", evaluator.at or tree.body) from None


class Evaluator(Operations):
    """Evaluates an expression."""

    def visit_Lambda(self, node: ast.Lambda) -> object:
        names = [argument.arg for argument in node.args.args]
        rest = (node.args.vararg, node.args.kwarg, *node.args.kwonlyargs, *node.args.posonlyargs, *node.args.defaults)
        if any(rest):
            raise self.problem("a lambda with more than plain arguments is not allowed", node)

        self.budget.spend(PER_FUNCTION)

        def call(*values: object) -> object:
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

    def visit_ListComp(self, node: ast.ListComp) -> object:
        return [self.visit(node.elt) for _ in self._loop(node.generators, inlined=True)]

    def visit_SetComp(self, node: ast.SetComp) -> object:
        return self.collect(self.visit(node.elt) for _ in self._loop(node.generators, inlined=True))

    def visit_DictComp(self, node: ast.DictComp) -> object:
        pairs = ((self.visit(node.key), self.visit(node.value)) for _ in self._loop(node.generators, inlined=True))
        return self.map_pairs(pairs)

    def visit_GeneratorExp(self, node: ast.GeneratorExp) -> object:
        return iter([self.visit(node.elt) for _ in self._loop(node.generators, inlined=False)])

    def _loop(self, generators: list[ast.comprehension], *, inlined: bool) -> Iterator[None]:
        first = self.visit(generators[0].iter)
        hides = not (inlined and _INLINED_COMPREHENSIONS)
        self.inside += hides
        variables = self.variables  # a function that is called has others
        variables.append({})
        try:
            yield from self._loop_over(generators, 0, first)
        finally:
            variables.pop()
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

    def _assign(self, target: ast.expr, value: object) -> None:
        if isinstance(target, ast.Name):
            self.variables[-1][target.id] = value
        elif isinstance(target, (ast.Tuple, ast.List)):
            if not isinstance(value, Iterable):
                raise TypeError(f"'{type(value).__name__}' object is not iterable")
            values = list(value)
            if len(values) != len(target.elts):
                raise self.problem(f"{len(values)} values, expected {len(target.elts)}", target)
            for part, item in zip(target.elts, values, strict=True):
                self._assign(part, item)
        else:
            raise self.problem(f"{describe(target)} is not allowed here", target)
