# ruff: noqa: N802 - methods have the names of the nodes of the syntax tree
"""Expressions of Python launch files, computed without Python's eval, each charged to a budget.

They are those of `$(eval ...)`, and more: names of the file, objects of the launch API, paths, calls of the file's own
functions. What cannot be computed is `Unknown`, and so is all that depends on it.
"""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import PurePosixPath
from typing import Any

from ur.launchfile.plan.values import expression_functions as functions
from ur.launchfile.plan.values.budget import PER_STEP, PER_YAML_CHARACTER, Budget, ExpressionProblem
from ur.launchfile.plan.values.expression import MAX_LENGTH, Evaluator
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.python.api_class import ApiClass
from ur.launchfile.ros2.python.objects import (
    BASE,
    CallFunction,
    Frame,
    Function,
    Instance,
    Module,
    Opened,
    UserClass,
    attribute_of,
    make_path,
)
from ur.launchfile.ros2.python.statements import is_generator
from ur.source.file import SourceFile, Span
from ur.source.suggest import suggest

_BUILT = re.compile(r"@\w+@")
_PER_EVAL = 500  # units of work
_TYPES: Mapping[str, type] = {"str": str, "int": int, "float": float, "bool": bool, "list": list, "dict": dict}


class Expressions(Evaluator):
    """Evaluates the expressions of one file. `frame` has the names that are known at a place."""

    def __init__(self, source: SourceFile, budget: Budget, frame: Frame) -> None:
        super().__init__(source.text, 0, {}, self._find_name, (), budget)
        self.source, self.frame = source, frame
        self._is_ascii = source.text.isascii()
        self.function: Function | None = None  # that is being called
        self.tries = 0  # how many `try` of the file are around this place
        self.yields: list[object] = []  # what the function has yielded that is being called
        self._generators: dict[ast.AST, bool] = {}  # of the functions that were called
        self.call_function: CallFunction = _not_called
        self.find_method: Callable[[object, str], object] = lambda *_: None
        """Return a method that needs the computer, of a value; None if it is none of those."""
        self.report: Callable[[DescriptionProblem], None] = lambda _: None
        self.make_context: Callable[[], object] = lambda: None

    def span(self, node: ast.AST) -> Span:
        """Return the span of a part of the file."""
        part: Any = node
        starts, first, last = self.source.line_starts(), part.lineno, part.end_lineno
        start, end = part.col_offset, part.end_col_offset
        if not self._is_ascii:
            start, end = self._column(first, start), self._column(last, end)
        return Span(self.source, starts[first - 1] + start, starts[last - 1] + end)

    def _column(self, line: int, column: int) -> int:
        return len(self.source.line(line).encode()[:column].decode(errors="replace"))

    def visit(self, node: ast.expr) -> object:
        """Return the value of a part of the expression."""
        method = _VISITS.get(type(node))
        if method is None:
            return super().visit(node)
        outer, self.at = self.at, node
        self.budget.spend(PER_STEP)
        value = method(self, node)
        self.at = outer
        return value

    def problem(self, message: str, node: ast.expr, *_: object) -> Any:
        """Return a problem at the position of a node."""
        return NotRead(message, self.span(node))

    def unknown(self, reason: str, node: ast.AST) -> Unknown:
        """Return a value that is not known, for a reason at a node."""
        return Unknown(reason, self.span(node))

    def _find_name(self, name: str) -> object:
        return self.frame.find(name)

    def visit_Name(self, node: ast.Name) -> object:
        for variables in reversed(self.variables):
            if node.id in variables:
                return variables[node.id]
        try:
            return self.frame.find(node.id)
        except KeyError:
            pass
        if node.id in functions.BUILTINS:
            found = functions.BUILTINS[node.id]
            return self.charged(node.id, found) if callable(found) and node.id not in _TYPES else found
        if node.id in _TYPES:
            return _TYPES[node.id]
        if node.id == "eval":
            return self._evaluate
        if node.id in BUILTINS:
            return self.unknown(f"'{node.id}' is not computed while reading", node)
        raise DescriptionProblem(
            f"'{node.id}' is not defined, expected a name that is imported or assigned before",
            "undefined-name",
            self.span(node),
            suggest(node.id, self.frame.names()) or "import it, or assign it",
            node.id,
        )

    def visit_Constant(self, node: ast.Constant) -> object:
        value = node.value
        if isinstance(value, str) and value[:1] == "@" and self.source.path.endswith(".in") and _BUILT.fullmatch(value):
            return Unknown(f"{value} is set when its package is built", self.span(node), "package")
        return value

    def _evaluate(self, text: object, *_: object) -> object:
        """Return the value of a text, as `eval`."""
        if not isinstance(text, str) or len(text) > MAX_LENGTH:
            raise ValueError(f"expected a text of at most {MAX_LENGTH:,} characters")
        self.budget.spend(_PER_EVAL + PER_YAML_CHARACTER * len(text))
        return self.visit(ast.parse(text.strip(), mode="eval").body)

    def yields_in(self, function: ast.FunctionDef | ast.Lambda) -> bool:
        """Return whether a function yields; its body is looked at once, however often it is called."""
        if function not in self._generators:
            self._generators[function] = is_generator(function)
        return self._generators[function]

    def visit_Yield(self, node: ast.Yield) -> None:
        self.yields.append(None if node.value is None else self.visit(node.value))
        functions.size_of(self.yields)

    def visit_YieldFrom(self, node: ast.YieldFrom) -> None:
        values = self.visit(node.value)
        if isinstance(values, Unknown):
            raise NotRead(values.reason, values.span or self.span(node))
        self.budget.weigh(values)
        self.yields += values if isinstance(values, Iterable) else iter(values)  # type: ignore[call-overload]
        functions.size_of(self.yields)

    def visit_Lambda(self, node: ast.Lambda) -> object:
        defaults = tuple(self.visit(each) for each in node.args.defaults)
        frame = self.frame
        for variables in self.variables:
            frame = Frame(frame, dict(variables))
        return Function("lambda", node, self.call_function, frame, defaults)

    def _loop_over(self, generators: list[ast.comprehension], level: int, items: Any) -> Iterator[None]:
        if isinstance(items, Unknown):
            raise NotRead(items.reason, items.span or self.span(generators[level].iter))
        yield from super()._loop_over(generators, level, items)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> object:
        value = self.visit(node.operand)
        return value if isinstance(value, Unknown) else functions.UNARY[type(node.op)](value)

    def visit_BinOp(self, node: ast.BinOp) -> object:
        left, right = self.visit(node.left), self.visit(node.right)
        if not _is_list_sum(left, right) and (unknown := self._first_unknown([left, right])) is not None:
            return unknown
        if isinstance(node.op, ast.Div) and isinstance(left, PurePosixPath):
            return make_path(left, right)
        if isinstance(node.op, ast.Div) and isinstance(left, Made) and left.kind.startswith("Path"):
            return Made("PathJoinSubstitution", {"substitutions": [left, right]}, self.span(node))
        if isinstance(left, Made) or isinstance(right, Made):
            return self.unknown("an operator is applied to an object of the launch API", node)
        return super().visit_BinOp(ast.copy_location(ast.BinOp(Known(left), node.op, Known(right)), node))

    def visit_Known(self, node: Known) -> object:
        """Return the value that has been computed."""
        return node.value

    def visit_BoolOp(self, node: ast.BoolOp) -> object:
        value: object = None
        for operand in node.values:
            value = self.visit(operand)
            if isinstance(value, Unknown) or bool(value) == isinstance(node.op, ast.Or):
                break
        return value

    def visit_Compare(self, node: ast.Compare) -> object:
        values = [self.visit(each) for each in (node.left, *node.comparators)]
        if (unknown := self._first_unknown(values)) is not None:
            return unknown
        known: list[ast.expr] = [Known(value) for value in values]
        return super().visit_Compare(ast.copy_location(ast.Compare(known[0], node.ops, known[1:]), node))

    def visit_IfExp(self, node: ast.IfExp) -> object:
        test = self.visit(node.test)
        return test if isinstance(test, Unknown) else self.visit(node.body if test else node.orelse)

    def visit_NamedExpr(self, node: ast.NamedExpr) -> object:
        self.frame.names_here[node.target.id] = value = self.visit(node.value)
        return value

    def visit_List(self, node: ast.List) -> object:
        return self._items(node.elts)

    def visit_Tuple(self, node: ast.Tuple) -> object:
        return tuple(self._items(node.elts))

    def _part(self, node: ast.expr) -> object:
        """Return the value of an item or argument: what is wrong there does not concern the others."""
        if type(node) is ast.Constant:
            self.budget.spend(PER_STEP)
            return self.visit_Constant(node)
        if self.tries:
            return self.visit(node)
        try:
            return self.visit(node)
        except NotRead as problem:
            return Unknown(problem.reason, problem.span)
        except DescriptionProblem as problem:
            self.report(problem)
            return Unknown(problem.message.partition(",")[0], problem.span)
        except (ExpressionProblem, KeyError, TypeError, ValueError, AttributeError, LookupError, OSError) as problem:
            text = f"{type(problem).__name__}: {problem}".rstrip(": ")
            return self.unknown(f"it raises {text}", self.at or node)

    def _items(self, nodes: list[ast.expr]) -> list[object]:
        found: list[object] = []
        for item in nodes:
            if not isinstance(item, ast.Starred):
                found.append(self._part(item))
                continue
            values: Any = self._part(item.value)
            if isinstance(values, Unknown):
                found.append(values)
            else:
                self.budget.weigh(values)
                found.extend(values)
        return found

    def visit_Dict(self, node: ast.Dict) -> object:
        found: dict[object, object] = {}
        for key, value in zip(node.keys, node.values, strict=True):
            made: Any = self._part(value)
            if key is not None:
                name = self._part(key)
                if isinstance(name, list):
                    name = tuple(name)
                self.budget.weigh(name)
                found[name] = made
            elif isinstance(made, dict):
                self.budget.weigh(made)
                found.update(made)
            else:
                found[Unknown("its names are not known")] = made
        return found

    def visit_Subscript(self, node: ast.Subscript) -> object:
        value, index = self.visit(node.value), self.visit(node.slice)
        for each in (value, index):
            if isinstance(each, Unknown):
                return each
        if isinstance(value, Mapping) and not isinstance(value, dict):
            return value[index]
        if isinstance(value, UserClass) and "__class_getitem__" not in value.members:
            return value  # of a generic class, for types of which alone its parts are
        if value is list and index in (bool, int, float, str):
            return list[index]  # type: ignore[valid-type]
        if isinstance(value, ApiClass | type) or value is None:
            return self.unknown("a type is not computed while reading", node)
        known = ast.copy_location(ast.Subscript(Known(value), Known(index), ast.Load()), node)
        try:
            return super().visit_Subscript(known)
        except DescriptionProblem as problem:  # a variable that is not set
            problem.span = self.span(node)
            raise

    def visit_JoinedStr(self, node: ast.JoinedStr) -> object:
        parts = [self.visit(part) for part in node.values]
        for part in parts:
            if isinstance(part, Unknown):
                return part
        return "".join(str(self.made(str(part))) for part in parts)

    def visit_FormattedValue(self, node: ast.FormattedValue) -> object:
        value = self.visit(node.value)
        if (unknown := self._first_unknown(value)) is not None:
            return unknown
        if isinstance(value, Made):
            return self.unknown("an object of the launch API is made a text before its value is known", node)
        if isinstance(value, Instance) and isinstance(value := self._text_of(value), Unknown):
            return value
        if isinstance(value, PurePosixPath):
            value = str(value)
        known = ast.copy_location(ast.FormattedValue(Known(value), node.conversion, node.format_spec), node)
        return super().visit_FormattedValue(known)

    def visit_Attribute(self, node: ast.Attribute) -> object:
        if (found := self._super_member(node)) is not None:
            return found
        value = self.visit(node.value)
        if isinstance(value, Unknown):
            return value
        if (found := self.find_method(value, node.attr)) is not None:
            return found
        own, found = attribute_of(value, node.attr, self.span(node), self.budget)
        if own:
            return found
        self.at = node
        try:
            found = functions.find_method(value, node.attr)
        except AttributeError:
            return self.unknown(f"'.{node.attr}' of a value of type {type(value).__name__} is not computed", node)
        return self.charged(node.attr, found, value) if callable(found) else found

    def visit_Call(self, node: ast.Call) -> object:
        function: Any = self.visit(node.func)
        if isinstance(function, Unknown):
            if self.tries:  # it could raise what the file handles
                raise NotRead(function.reason, function.span or self.span(node))
            return function
        arguments = self._items(node.args)
        keywords = self._keywords(node)
        if isinstance(keywords, Unknown):
            return keywords
        self.at = node
        owner = self._initialised(node.func)
        if owner is not None and owner.of.api is not None:
            function = owner.of.api
        if isinstance(function, ApiClass):
            made = function.make(arguments, keywords, node, self.span, self.report)
            if owner is not None:
                owner.attributes[BASE] = made
            return made if made.kind != "LaunchContext" else self.make_context()
        if isinstance(function, Function):
            return function.run(arguments, keywords)
        if isinstance(function, UserClass):
            return function.make(arguments, keywords)
        return self._call_native(function, arguments, keywords, node)

    def _super_member(self, node: ast.Attribute) -> object:
        """Return a member of `super()`; None if it is none of a class of a file."""
        owner = self._of_super(node)
        member = None
        if owner is not None:
            self.budget.spend(len(owner.of.members))
            member = owner.of.find_super(node.attr, self.function)
        return None if owner is None or member is None else owner.bound(member, member)

    def _initialised(self, node: ast.expr) -> Instance | None:
        """Return the object whose base in the launch API `super().__init__()` is called for."""
        owner = self._of_super(node) if isinstance(node, ast.Attribute) and node.attr == "__init__" else None
        return None if owner is None or owner.of.find_super("__init__", self.function) is not None else owner

    def _of_super(self, node: ast.expr) -> Instance | None:
        """Return the object whose base `super().NAME` asks for."""
        if not isinstance(node, ast.Attribute) or not isinstance(called := node.value, ast.Call):
            return None
        if not isinstance(called.func, ast.Name) or called.func.id != "super":
            return None
        first = next(iter(self.frame.names_here.values()), None)
        return first if isinstance(first, Instance) else None

    def _keywords(self, node: ast.Call) -> dict[str, object] | Unknown:
        found: dict[str, object] = {}
        for keyword in node.keywords:
            value = self._part(keyword.value)
            if keyword.arg is not None:
                found[keyword.arg] = value
            elif isinstance(value, dict):
                found.update({str(name): each for name, each in value.items()})
            else:
                return value if isinstance(value, Unknown) else self.unknown("'**' of no dict", node)
        return found

    def _call_native(self, function: Any, arguments: list[Any], keywords: dict[str, object], node: ast.Call) -> object:
        if getattr(function, "takes_unknown", False):
            self.budget.weigh(arguments)
            return self.made(function(*arguments, **keywords))
        if (unknown := self._first_unknown([*arguments, *keywords.values()])) is not None:
            return unknown
        if not callable(function) or isinstance(function, Module | Opened):
            return self.unknown(f"a call of {type(function).__name__} is not computed", node)
        if function in (str, int, float, bool) and any(isinstance(each, Made) for each in arguments):
            return self.unknown("an object of the launch API is converted before its value is known", node)
        if function is str and len(arguments) == 1 and isinstance(arguments[0], Instance):
            return self._text_of(arguments[0])
        if isinstance(function, type) and issubclass(function, PurePosixPath):
            function = make_path
        return self.made(function(*arguments, **keywords))

    def _text_of(self, value: Instance) -> object:
        found = value.of.members.get("__str__")
        if isinstance(found, Function):
            return found.run([value], {})
        return Unknown(f"the text of an object of {value.of.name} is not computed while reading")

    def _first_unknown(self, value: object) -> Unknown | None:
        self.budget.weigh(value)
        return first_unknown(value)


class NotRead(Exception):  # noqa: N818 - the reason why a value is Unknown
    """A part of a file that is not computed while reading."""

    def __init__(self, reason: str, span: Span) -> None:
        super().__init__(reason)
        self.reason, self.span = reason, span


class Known(ast.expr):
    """A value that has been computed, in the place of an expression."""

    def __init__(self, value: object) -> None:
        super().__init__()
        self.value = value
        self.lineno = self.end_lineno = 1
        self.col_offset = self.end_col_offset = 0


_VISITS: Mapping[type[ast.expr], Callable[[Expressions, Any], object]] = {
    kind: getattr(Expressions, f"visit_{kind.__name__}")
    for kind in ast.expr.__subclasses__()
    if hasattr(Expressions, f"visit_{kind.__name__}")
}


def first_unknown(value: object) -> Unknown | None:
    """Return the first Unknown in a value, its items included; None if all is known."""
    if isinstance(value, Unknown):
        return value
    if isinstance(value, (list, tuple)):
        for item in value:
            if (found := first_unknown(item)) is not None:
                return found
    if isinstance(value, dict):
        return first_unknown([*value, *value.values()])
    return None


def _is_list_sum(left: object, right: object) -> bool:
    return isinstance(left, (list, tuple)) and isinstance(right, (list, tuple))


BUILTINS: Mapping[str, object] = vars(builtins)


def builtin_exception(node: ast.AST | None) -> type[Exception] | None:
    """Return the exception of Python that a name stands for, as far as a file may raise it."""
    kind = BUILTINS.get(node.id) if isinstance(node, ast.Name) else None
    is_raised = isinstance(kind, type) and issubclass(kind, Exception) and not issubclass(kind, RecursionError)
    return kind if is_raised else None  # type: ignore[return-value]


def _not_called(*_: object) -> object:
    raise TypeError("functions are called by a reader")
