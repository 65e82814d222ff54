"""`$(eval ...)`: the Python expressions that roslaunch evaluates, without Python's eval.

roslaunch passes the text to Python's `eval` after refusing double underscores. This evaluator omits everything harmful
(files, imports, introspection, endless computing); the features that launch files use are the same, including values
and quirks: constants and functions of `math` take precedence over arguments of the same name, and inside a
comprehension only its own variables and Python's built-in functions are known (before Python 3.12).
"""

import ast
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from ur.launchfile.plan.problems import NOT_PYTHON, TagRefused
from ur.launchfile.plan.values.budget import PER_FUNCTION, PER_STEP, Budget, ExpressionProblem, TooLong
from ur.launchfile.plan.values.expression_operations import Operations, describe
from ur.launchfile.syntax.substitution import SubstitutionProblem

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
        message = f"not a Python expression: {problem or 'nested too deep'}"
        raise ExpressionProblem(message, kind=NOT_PYTHON) from None
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

    def visit_Lambda(self, node: ast.Lambda) -> object:  # noqa: N802
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

    def visit_ListComp(self, node: ast.ListComp) -> object:  # noqa: N802
        return [self.visit(node.elt) for _ in self._loop(node.generators, inlined=True)]

    def visit_SetComp(self, node: ast.SetComp) -> object:  # noqa: N802
        return self.collect(self.visit(node.elt) for _ in self._loop(node.generators, inlined=True))

    def visit_DictComp(self, node: ast.DictComp) -> object:  # noqa: N802
        pairs = ((self.visit(node.key), self.visit(node.value)) for _ in self._loop(node.generators, inlined=True))
        return self.map_pairs(pairs)

    def visit_GeneratorExp(self, node: ast.GeneratorExp) -> object:  # noqa: N802
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
