"""`$(eval ...)` of ROS 1 as an expression of ROS 2.

ROS 1 gives an expression the values of arguments, which may be numbers or flags. ROS 2 puts their texts into the
expression before Python reads it. So each use of an argument decides as what it is written: as a text in quotes, as a
number, or as a test that holds for all but an empty text, `false` and `0`.
"""

import ast
import builtins
import math
from collections.abc import Callable
from typing import Literal

Want = Literal["text", "number", "truth", "any"]
_FALSE = ("", "false", "0", "0.0")
_NUMBER = "ur_number_of_"
_TEXT_METHODS = frozenset(name for name in dir(str) if not name.startswith("_"))
_TEXT_FUNCTIONS = frozenset({"str", "repr", "format", "chr"})
_NUMBER_FUNCTIONS = frozenset({"int", "float", "abs", "round", "min", "max", "sum", "len", "pow", "divmod"})
_OF_NUMBERS = frozenset({"abs", "round", "min", "max", "pow", "divmod"})
_OF_TEXTS = frozenset({"len", "sorted"})
_MATH = frozenset(name for name in dir(math) if not name.startswith("_"))


class NotConvertible(Exception):  # noqa: N818 - carries a finding to where its place is known
    """An expression has no counterpart; the text says why, `help` what to do."""

    def __init__(self, message: str, help: str) -> None:
        super().__init__(message)
        self.help = help


def convert_expression(text: str, want: Want = "any") -> str:
    """The whole `$(eval "...")` for the expression of ROS 1's, whose value is used as `want`. Raises NotConvertible."""
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise NotConvertible("not a Python expression", "ur check explains it") from None
    converter = _Converter()
    python = ast.unparse(ast.fix_missing_locations(converter.convert(tree, want)))
    for name in converter.numbers:
        python = python.replace(f"{_NUMBER}{name}_", f"($(var {name}))")
    escaped = python.replace("\\", "\\\\").replace('"', '\\"')
    return f'$(eval "{escaped}" "math, os")' if converter.uses_os else f'$(eval "{escaped}")'


class _Converter:
    def __init__(self) -> None:
        self.numbers: set[str] = set()
        self.uses_os = False

    def convert(self, node: ast.expr, want: Want) -> ast.expr:
        """An expression whose value is used as `want`."""
        name = _argument_of(node)
        if name is not None:
            if not name.isidentifier():
                raise NotConvertible(f"the argument name '{name}'", "rename the argument")
            if want == "number":
                self.numbers.add(name)
                return ast.Name(f"{_NUMBER}{name}_", ast.Load())
            text = ast.Constant(f"$(var {name})")
            return _is_one_of(text, _FALSE, ast.NotIn()) if want == "truth" else text
        handler: Callable[[ast.expr, Want], ast.expr] | None = getattr(self, f"_{type(node).__name__}", None)
        if handler is None:
            raise NotConvertible(
                f"{type(node).__name__} in an expression",
                "compute it where the arguments are given, and pass the value",
            )
        return handler(node, want)

    def _Constant(self, node: ast.Constant, _want: Want) -> ast.expr:  # noqa: N802
        if isinstance(node.value, str) and "$(" in node.value:
            raise NotConvertible("'$(' in a text of an expression", "leave it out")
        return node

    def _Name(self, node: ast.Name, _want: Want) -> ast.expr:  # noqa: N802
        return {"true": ast.Constant(True), "false": ast.Constant(False)}.get(node.id, node)

    def _BoolOp(self, node: ast.BoolOp, want: Want) -> ast.expr:  # noqa: N802
        if any(_kind(each) == "truth" for each in node.values):
            want = "truth"
        return ast.BoolOp(node.op, [self.convert(each, want) for each in node.values])

    def _UnaryOp(self, node: ast.UnaryOp, _want: Want) -> ast.expr:  # noqa: N802
        name = _argument_of(node.operand)
        if isinstance(node.op, ast.Not) and name is not None:
            return _is_one_of(ast.Constant(f"$(var {name})"), _FALSE, ast.In())
        return ast.UnaryOp(node.op, self.convert(node.operand, "truth" if isinstance(node.op, ast.Not) else "number"))

    def _IfExp(self, node: ast.IfExp, want: Want) -> ast.expr:  # noqa: N802
        body, otherwise = (self.convert(each, want) for each in (node.body, node.orelse))
        return ast.IfExp(self.convert(node.test, "truth"), body, otherwise)

    def _Compare(self, node: ast.Compare, _want: Want) -> ast.expr:  # noqa: N802
        sides = [node.left, *node.comparators]
        if len(sides) == 2 and (test := self._truth_test(sides, node.ops[0])) is not None:
            return test
        kinds = {_kind(each) for each in sides} - {"any"}
        if len(kinds) > 1:
            raise NotConvertible("a comparison of a text with a number", "compare texts: str(arg('name')) == '1'")
        want: Want = "number" if kinds == {"number"} else "text"
        left, *others = (self.convert(each, want) for each in sides)
        return ast.Compare(left, node.ops, others)

    def _truth_test(self, sides: list[ast.expr], op: ast.cmpop) -> ast.expr | None:
        """The test for `argument == True` and the like."""
        for argument, value in (sides, sides[::-1]):
            name = _argument_of(argument)
            flag = _flag_of(value)
            if name is None or flag is None or not isinstance(op, (ast.Eq, ast.NotEq, ast.Is, ast.IsNot)):
                continue
            among = ast.In() if isinstance(op, (ast.Eq, ast.Is)) else ast.NotIn()
            return _is_one_of(ast.Constant(f"$(var {name})"), ("true", "1", "1.0") if flag else _FALSE[1:], among)
        return None

    def _BinOp(self, node: ast.BinOp, want: Want) -> ast.expr:  # noqa: N802
        kinds = {_kind(node.left), _kind(node.right)}
        if isinstance(node.op, ast.Add) and kinds == {"any"} and want not in ("text", "number"):
            message = "arguments that may be texts or numbers are added"
            raise NotConvertible(
                message, "say which: str(arg('a')) + str(arg('b')), or float(arg('a')) + float(arg('b'))"
            )
        if ("text" in kinds and isinstance(node.op, (ast.Add, ast.Mod))) or (
            want == "text" and isinstance(node.op, ast.Add)
        ):
            sides: tuple[Want, Want] = ("text", "text" if isinstance(node.op, ast.Add) else "any")
        elif "text" in kinds and isinstance(node.op, ast.Mult):
            sides = ("any", "number") if _kind(node.left) == "text" else ("number", "any")
        else:
            sides = ("number", "number")
        return ast.BinOp(self.convert(node.left, sides[0]), node.op, self.convert(node.right, sides[1]))

    def _Call(self, node: ast.Call, _want: Want) -> ast.expr:  # noqa: N802
        if isinstance(node.func, ast.Attribute):
            of_math = isinstance(node.func.value, ast.Name) and node.func.value.id == "math"
            owner = self.convert(node.func.value, "any" if of_math else "text")
            given = [self.convert(each, "number" if of_math else "any") for each in node.args]
            return ast.Call(ast.Attribute(owner, node.func.attr, ast.Load()), given, [])
        if not isinstance(node.func, ast.Name) or node.keywords:
            raise NotConvertible("a call in an expression", "compute it outside of the launch file")
        return self._call_by_name(node.func.id, node)

    def _call_by_name(self, name: str, node: ast.Call) -> ast.expr:
        if name in ("env", "optenv", "find", "anon", "dirname"):
            return self._command(name, node)
        if name in ("int", "float") and len(node.args) == 1 and _argument_of(node.args[0]):
            value = self.convert(node.args[0], "text")
            number = ast.Call(ast.Name("float", ast.Load()), [value], [])
            return ast.Call(ast.Name("int", ast.Load()), [number], []) if name == "int" else number
        if name == "str" and len(node.args) == 1 and _argument_of(node.args[0]):
            return self.convert(node.args[0], "text")
        if name == "bool" and len(node.args) == 1:
            return ast.Call(node.func, [self.convert(node.args[0], "truth")], [])
        if name not in _MATH and not hasattr(builtins, name):
            raise NotConvertible(f"the function '{name}' in an expression", "compute it outside of the launch file")
        want: Want = "number" if name in _OF_NUMBERS | _MATH else "text" if name in _OF_TEXTS else "any"
        return ast.Call(node.func, [self.convert(each, want) for each in node.args], [])

    def _command(self, name: str, node: ast.Call) -> ast.expr:
        if name in ("env", "optenv"):
            if not node.args:
                raise NotConvertible(f"{name}() without a name", f"write the name: {name}('NAME')")
            self.uses_os = True
            variable, *default = (self.convert(each, "text") for each in node.args)
            environment = ast.Attribute(ast.Name("os", ast.Load()), "environ", ast.Load())
            if name == "env":
                return ast.Subscript(environment, variable, ast.Load())
            get = ast.Attribute(environment, "get", ast.Load())
            return ast.Call(get, [variable, *(default or [ast.Constant("")])], [])
        if name == "dirname":
            return ast.Constant("$(dirname)")
        value = node.args[0] if node.args else None
        if not isinstance(value, ast.Constant) or not isinstance(value.value, str):
            raise NotConvertible(f"{name}() of a value that is computed", f"write the name: {name}('name')")
        return ast.Constant(f"$({'find-pkg-share' if name == 'find' else name} {value.value})")

    def _Subscript(self, node: ast.Subscript, _want: Want) -> ast.expr:  # noqa: N802
        return ast.Subscript(self.convert(node.value, "text"), self.convert(node.slice, "any"), ast.Load())

    def _Slice(self, node: ast.Slice, _want: Want) -> ast.expr:  # noqa: N802
        parts = [each and self.convert(each, "number") for each in (node.lower, node.upper, node.step)]
        return ast.Slice(*parts)

    def _List(self, node: ast.List, want: Want) -> ast.expr:  # noqa: N802
        return ast.List([self.convert(each, want) for each in node.elts], ast.Load())

    def _Tuple(self, node: ast.Tuple, want: Want) -> ast.expr:  # noqa: N802
        return ast.Tuple([self.convert(each, want) for each in node.elts], ast.Load())

    def _Attribute(self, node: ast.Attribute, _want: Want) -> ast.expr:  # noqa: N802
        return ast.Attribute(self.convert(node.value, "any"), node.attr, ast.Load())


def _is_one_of(text: ast.expr, texts: tuple[str, ...], op: ast.cmpop) -> ast.expr:
    lowered = ast.Call(ast.Attribute(text, "lower", ast.Load()), [], [])
    return ast.Compare(lowered, [op], [ast.Tuple([ast.Constant(each) for each in texts], ast.Load())])


def _argument_of(node: ast.expr) -> str | None:
    """The argument whose value an expression is; None for any other."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "arg" and node.args:
        name = node.args[0]
        return name.value if isinstance(name, ast.Constant) and isinstance(name.value, str) else None
    if isinstance(node, ast.Name) and node.id not in {"true", "false", "math"} | _MATH:
        return None if hasattr(builtins, node.id) else node.id
    return None


def _flag_of(node: ast.expr) -> bool | None:
    if isinstance(node, ast.Constant) and isinstance(node.value, bool):
        return node.value
    return {"true": True, "false": False}.get(node.id) if isinstance(node, ast.Name) else None


def _kind(node: ast.expr) -> Want:
    """The kind of value of an expression for all values of its arguments; `any` where that depends on them."""
    if isinstance(node, ast.Constant):
        return "truth" if isinstance(node.value, bool) else "text" if isinstance(node.value, str) else "number"
    if isinstance(node, (ast.Compare, ast.JoinedStr)) or (
        isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    ):
        return "text" if isinstance(node, ast.JoinedStr) else "truth"
    if isinstance(node, ast.IfExp):
        return _common(node.body, node.orelse)
    if isinstance(node, ast.BoolOp):
        return _common(node.values[0], node.values[-1])
    if isinstance(node, (ast.List, ast.Tuple)) and node.elts:
        return _common(node.elts[0], node.elts[-1])
    if isinstance(node, ast.BinOp):
        kinds = {_kind(node.left), _kind(node.right)}
        return "text" if "text" in kinds else "any" if kinds == {"any"} and isinstance(node.op, ast.Add) else "number"
    if isinstance(node, ast.Call):
        function = node.func
        if isinstance(function, ast.Attribute):
            return "text" if function.attr in _TEXT_METHODS - {"split", "startswith", "endswith"} else "any"
        name = function.id if isinstance(function, ast.Name) else ""
        if name in _TEXT_FUNCTIONS | {"env", "optenv", "find", "anon", "dirname"}:
            return "text"
        return "number" if name in _NUMBER_FUNCTIONS | _MATH else "any"
    return "any"


def _common(left: ast.expr, right: ast.expr) -> Want:
    kinds = {_kind(left), _kind(right)}
    known = kinds - {"any"}
    return known.pop() if len(known) == 1 and ("text" in kinds or len(kinds) == 1) else "any"
