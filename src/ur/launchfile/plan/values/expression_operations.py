# ruff: noqa: N802 - methods have the names of the nodes of the syntax tree
"""Names, operators, containers and calls of the expressions in `$(eval ...)`, each charged to a budget."""

import ast
from collections.abc import Callable, ItemsView, Iterable, KeysView, Mapping
from typing import Any

from ur.launchfile.plan.values import expression_functions as functions
from ur.launchfile.plan.values.budget import (
    COSTS,
    PER_FUNCTION,
    PER_STEP,
    Budget,
    ExpressionProblem,
    divide_cost,
    hash_cost,
)
from ur.launchfile.plan.values.expression_formats import CONVERSIONS, format_value
from ur.source.suggest import did_you_mean

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
        near = did_you_mean(name, known)
        raise self.problem(
            f"'{name}' is not known, expected an argument or a function",
            node,
            f"did you mean {near}?" if near else f'declare it: <arg name="{name}" .../>, or quote it as a text',
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
