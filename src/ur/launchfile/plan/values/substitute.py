"""Values of `$(...)`, exactly as roslaunch computes them.

roslaunch works on text: it replaces each `$(...)` everywhere in the value it has so far, those other than `find` first.
So the value of an argument may contain a `$(find)`, which is resolved; any other command stays.
"""

# Paths are texts here: pathlib would change what roslaunch prints, and costs too much in hot loops.
# ruff: noqa: PTH118, PTH120

import os
from collections.abc import Callable

from ur.launchfile.plan.problems import TagRefused
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.plan.values.convert import guess_value
from ur.launchfile.syntax.substitution import COMMANDS, Substitution, SubstitutionProblem, is_eval, parse_substitutions
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.source.suggest import did_you_mean, get_command, suggest

MAX_RESULT = 1024 * 1024


class MissingArgument(SubstitutionProblem):
    """`$(arg name)` of an argument without a value. `name` is the argument's."""

    def __init__(self, name: str, start: int, end: int) -> None:
        super().__init__(f"argument '{name}' has no value", start, end, "undeclared-argument")
        self.name = name


def substitute(value: str, scope: Scope, world: World, budget: Budget) -> str:
    """Return a value with every `$(...)` replaced; expressions are charged to the budget.

    Raises SubstitutionProblem, or TagRefused if the cause was already reported.
    """
    if "$" not in value:
        return value
    pieces = parse_substitutions(value)
    if is_eval(value):
        return _evaluate(pieces[0], scope, world, budget)
    if len(pieces) == 1 and pieces[0].command == "arg" and len(pieces[0].words) == 1:
        known = scope.args.get(pieces[0].words[0].text)  # the most frequent case by far
        if known is not None and "$" not in known and pieces[0].end - pieces[0].start == len(value):
            return known
    resolved = value
    finds = 0
    for piece in pieces:
        _check_command(piece)
        if piece.command == "find":
            finds += 1
        else:
            resolved = resolved.replace(f"$({piece.content})", _value_of(piece, scope, world))
            _check_length(resolved, piece)
    if not finds and "$" not in resolved:
        return resolved
    for piece in _pieces_of_result(resolved, value):
        _check_command(piece)
        if piece.command == "find":
            package = _only_word(piece, "a package")
            before, _, after = resolved.partition(f"$({piece.content})")
            path, space, rest = after.partition(" ")
            path = path.replace("\\", "/").removeprefix("/")
            resolved = before + find_path(package, path, piece.start, piece.end, world) + space + rest
            _check_length(resolved, piece)
    return resolved


def _pieces_of_result(resolved: str, value: str) -> tuple[Substitution, ...]:
    # Pieces that the value itself holds get their place in it; others, which an argument brought in, the whole value.
    try:
        pieces = parse_substitutions(resolved)
    except SubstitutionProblem as problem:
        raise SubstitutionProblem(problem.message, 0, len(value), problem.rule, problem.help) from None
    placed = []
    for piece in pieces:
        start = value.find(f"$({piece.content})")
        end = start + len(piece.content) + 3 if start != -1 else len(value)
        placed.append(Substitution(piece.command, piece.content, piece.words, max(start, 0), end))
    return tuple(placed)


def _check_command(piece: Substitution) -> None:
    if piece.command in COMMANDS:
        return
    near = did_you_mean(piece.command, [*COMMANDS, "eval"])
    help_ = f"did you mean $({near} ...)?" if near else f"known: {', '.join(COMMANDS)}, eval"
    if piece.command == "eval":
        help_ = "$(eval ...) has to be the whole value, with nothing before or after it"
    raise SubstitutionProblem(
        f"unknown substitution '{piece.command}', expected one of {', '.join(COMMANDS)}",
        piece.start,
        piece.end,
        help=help_,
    )


def _check_length(text: str, piece: Substitution) -> None:
    if len(text) > MAX_RESULT:
        raise SubstitutionProblem(
            f"the value grows to {len(text):,} characters here, expected at most {MAX_RESULT:,}",
            piece.start,
            piece.end,
            "value-too-long",
        )


def _value_of(piece: Substitution, scope: Scope, world: World) -> str:
    words = [word.text for word in piece.words]
    if piece.command == "arg":
        return look_up_argument(_only_word(piece, "an argument"), scope, piece.start, piece.end)
    if piece.command == "env":
        return _environment_variable(_only_word(piece, "an environment variable"), world, piece.start, piece.end)
    if piece.command == "optenv":
        if not words:
            _only_word(piece, "an environment variable")
        return world.environment.get(words[0], " ".join(words[1:]))
    if piece.command == "anon":
        return _anonymous(_only_word(piece, "a node name"), scope, world)
    return folder_of(scope.filename, world)


def _only_word(piece: Substitution, what: str) -> str:
    if len(piece.words) == 1:
        return piece.words[0].text
    found = "nothing" if not piece.words else f"{len(piece.words)} words"
    raise SubstitutionProblem(
        f"$({piece.command}) is given {found}, expected {what}",
        piece.start,
        piece.end,
        help=f"write $({piece.command} NAME)",
    )


def look_up_argument(name: str, scope: Scope, start: int, end: int) -> str:
    """Return the value of an argument. Raises MissingArgument, or TagRefused if it could not be resolved earlier."""
    try:
        return scope.args[name]
    except KeyError:
        if name in scope.poisoned:
            raise TagRefused(None) from None
        raise MissingArgument(name, start, end) from None


def folder_of(filename: str, world: World) -> str:
    """Resolve `$(dirname)`: the folder of the launch file."""
    return world.absolute(os.path.dirname(filename))


def _environment_variable(name: str, world: World, start: int, end: int) -> str:
    try:
        return world.environment[name]
    except KeyError:
        near = did_you_mean(name, world.environment)
        help_ = f"set it (export {name}=...), or give a default: $(optenv {name} DEFAULT)"
        raise SubstitutionProblem(
            f"environment variable {name} is not set, expected a value",
            start,
            end,
            "unset-variable",
            f"did you mean {near}? Otherwise {help_}" if near else help_,
        ) from None


def _anonymous(name: str, scope: Scope, world: World) -> str:
    if name not in scope.anonymous:
        scope.anonymous[name] = world.make_anonymous(name)
    return scope.anonymous[name]


def find_path(package: str, path: str, start: int, end: int, world: World) -> str:
    """Resolve `$(find package)/path`, or `$(find package)` when the path is empty. Raises SubstitutionProblem."""
    try:
        special = world.find_in_package(package, path) if path else None
        if special is not None:
            return special
        folder = world.find_package(package)
        return os.path.join(folder, path) if path else folder
    except PackageNotFound:
        help_ = (
            suggest(package, world.package_names())
            or f"{get_command(package)}, or put the folder that holds it on ROS_PACKAGE_PATH (source its setup.bash)"
        )
        raise SubstitutionProblem(
            f"package '{package}' is not found, expected an installed one",
            start,
            end,
            "unknown-package",
            help_,
            package,
        ) from None
    except (OSError, ValueError) as problem:
        raise SubstitutionProblem(
            f"packages cannot be searched: {problem}",
            start,
            end,
            "broken-package",
            "repair or remove that file; roslaunch cannot find any package because of it",
        ) from None


def _evaluate(piece: Substitution, scope: Scope, world: World, budget: Budget) -> str:
    from ur.launchfile.plan.values.expression import ExpressionProblem, evaluate_expression  # 3 ms that few files need

    start, end = piece.start, piece.end
    functions: dict[str, Callable[..., object]] = {
        "arg": lambda name: guess_value(look_up_argument(name, scope, start, end)),
        "anon": lambda name: _anonymous(name, scope, world),
        "dirname": lambda: folder_of(scope.filename, world),
        "env": lambda name: _environment_variable(name, world, start, end),
        "optenv": lambda name, default="": world.environment.get(name, default),
        "find": lambda package: find_path(package, "", start, end, world),
    }

    def look_up(name: str) -> object:
        if name in scope.poisoned and name not in scope.args:
            raise TagRefused(None)
        return guess_value(scope.args[name])

    try:
        result = evaluate_expression(piece.content, functions, look_up, scope.args, budget)
    except ExpressionProblem as problem:
        offset = start + len("$(eval ")
        where = (offset + problem.start, offset + problem.end) if problem.end > problem.start else (start, end)
        raise SubstitutionProblem(
            f"$(eval): {problem}", *where, "bad-eval", problem.help, problem.subject, problem.kind
        ) from None
    return result
