"""PythonExpression: one expression, with the modules that it names."""

import ast
from collections.abc import Sequence

from ur.launchfile.plan.values import expression_functions as functions
from ur.launchfile.plan.values.budget import ExpressionProblem, TooLong
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.python.expressions import Expressions, NotRead
from ur.launchfile.ros2.python.modules import Library
from ur.launchfile.ros2.python.objects import Frame
from ur.launchfile.ros2.substitutions import PERFORM, perform
from ur.source.file import SourceFile

MAX_LENGTH = 20_000


def perform_expression(made: Made, context: Context) -> str | Unknown:
    """Return the text of a PythonExpression. Raises DescriptionProblem."""
    text = perform(made.get("expression", ""), context)
    if isinstance(text, Unknown):
        return text
    names = made.get("python_modules", ["math"])
    modules = [perform(name, context) for name in names] if isinstance(names, (list, tuple)) else ["math"]
    try:
        return evaluate(text, [name for name in modules if isinstance(name, str)], context)
    except ExpressionProblem as problem:
        raise DescriptionProblem(
            f"the expression {text!r} cannot be computed: {problem}", "bad-eval", made.place("expression"), problem.help
        ) from None
    except TooLong as problem:
        raise DescriptionProblem(f"the expression {problem}", "bad-eval", made.place("expression")) from None


def evaluate(text: str, modules: Sequence[str], context: Context) -> str | Unknown:
    """Return the value of an expression as a text. Raises ExpressionProblem, and TooLong of the budget."""
    if len(text) > MAX_LENGTH:
        raise ExpressionProblem(f"{len(text):,} characters, expected at most {MAX_LENGTH:,}")
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as problem:
        raise ExpressionProblem(f"it is no Python expression: {getattr(problem, 'msg', problem)}") from None
    library = Library(context, "<expression>")
    names: dict[str, object] = dict(functions.MATH) if "math" in modules else {}
    for name in modules:
        found = library.find(name)
        names[name] = found if found is not None else Unknown(f"the module {name} is not followed while reading")
    evaluator = Expressions(SourceFile("<expression>", text.strip()), context.budget, Frame(names=names))
    try:
        value = evaluator.visit(tree.body)
        context.budget.weigh(value)
    except NotRead as problem:
        return Unknown(problem.reason)
    except DescriptionProblem as problem:
        word = problem.subject
        help_ = 'quote it as a text: "\'", LaunchConfiguration(...), "\'"'
        if word in ("true", "false"):
            help_ = (
                f"Python writes {word.capitalize()}; compare texts: \"'\", LaunchConfiguration(...), \"' == '{word}'\""
            )
        raise ExpressionProblem(problem.message.partition(",")[0], help=help_) from None
    except (ExpressionProblem, RecursionError, TooLong):
        raise
    except Exception as problem:  # what Python raises for the values
        raise ExpressionProblem(f"{type(problem).__name__}: {problem}") from None
    return value if isinstance(value, Unknown) else str(value)


PERFORM["PythonExpression"] = perform_expression
