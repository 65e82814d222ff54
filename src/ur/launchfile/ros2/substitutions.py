"""Substitutions and conditions: from what a launch file writes to a text, in a context."""

import shutil
from collections.abc import Callable, Mapping
from pathlib import PurePosixPath
from typing import Any

from ur.launchfile.plan.problems import INHERITED
from ur.launchfile.plan.specs import ParameterValues
from ur.launchfile.plan.values.budget import PER_YAML_CHARACTER, Budget
from ur.launchfile.plan.written import LOG_FOLDER, run_with_files
from ur.launchfile.ros2.context import ANY_NAME, PER_SYSTEM_CALL, Context
from ur.launchfile.ros2.model import DescriptionProblem, Made, Unknown
from ur.source.arguments import split_words
from ur.source.suggest import suggest

TRUE, FALSE = ("true", "1"), ("false", "0")


def perform(value: object, context: Context) -> str | Unknown:
    """Return the text of a substitution, a text, a path, or a list of these. Raises DescriptionProblem."""
    text = value if isinstance(value, str) else _perform(value, context)
    context.budget.charge(1 + len(text) // 8 if isinstance(text, str) else 1)
    return text


def _perform(value: object, context: Context) -> str | Unknown:
    if isinstance(value, Unknown):
        return value
    if isinstance(value, PurePosixPath):
        return str(value)
    if isinstance(value, Made):
        known = PERFORM.get(value.kind)
        if known is None:
            raise DescriptionProblem(
                f"{value.kind} stands where a text is needed, expected a substitution", "launch-value", value.span, None
            )
        context.budget.charge(20)
        found = known(value, context)
        if context.on_value is not None and isinstance(found, str):
            context.on_value(value, found)
        return found
    if isinstance(value, (list, tuple)):
        parts = [perform(part, context) for part in value]
        for part in parts:
            if isinstance(part, Unknown):
                return part
        return "".join(map(str, parts))
    if isinstance(value, (bool, int, float)):
        return str(value)
    own = getattr(value, "perform", None)
    if own is not None:
        text = own(context)
        text = perform(text, context) if isinstance(text, Made) else text
        return text if isinstance(text, str | Unknown) else Unknown("it is no text")
    return Unknown(f"a value of type {type(value).__name__} is no text")


def perform_flag(value: object, context: Context, made: Made, name: str) -> bool | Unknown:
    """Return a flag that may be written as a substitution."""
    if isinstance(value, bool | Unknown):
        return value
    text = perform(value, context)
    return text if isinstance(text, Unknown) else read_flag(text, made, name)


def read_flag(text: str, made: Made, name: str) -> bool:
    """Return the value of a condition. Raises DescriptionProblem for a text that is neither true nor false."""
    word = text.strip().lower()
    if word in TRUE:
        return True
    if word in FALSE:
        return False
    near = {"yes": "true", "on": "true", "y": "true", "t": "true", "no": "false", "off": "false", "": "false"}.get(word)
    help_ = f"write '{near}'" if near else "compare it: EqualsSubstitution or PythonExpression"
    message = f"the condition is '{text}', expected 'true', '1', 'false' or '0'"
    raise DescriptionProblem(message, "bad-condition", made.place(name), help_, text)


def is_wanted(condition: object, context: Context) -> bool | Unknown:
    """Return whether a condition holds; True for None."""
    if condition is None:
        return True
    if isinstance(condition, Unknown):
        return condition
    if not isinstance(condition, Made) or condition.kind not in _CONDITIONS:
        span = condition.span if isinstance(condition, Made) else None
        raise DescriptionProblem("the condition is no condition, expected IfCondition or another", "launch-value", span)
    return _CONDITIONS[condition.kind](condition, context)


def _if(made: Made, context: Context) -> bool | Unknown:
    text = perform(made.get("predicate_expression"), context)
    return text if isinstance(text, Unknown) else read_flag(text, made, "predicate_expression")


def _unless(made: Made, context: Context) -> bool | Unknown:
    wanted = _if(made, context)
    return wanted if isinstance(wanted, Unknown) else not wanted


def _configuration_equals(made: Made, context: Context) -> bool | Unknown:
    name = perform(made.get("launch_configuration_name"), context)
    if isinstance(name, Unknown):
        return name
    value, wanted = context.configurations.get(name), made.get("expected_value")
    if isinstance(value, Unknown) or wanted is None:
        return value if isinstance(value, Unknown) else value is None
    text = perform(wanted, context)
    return text if isinstance(text, Unknown) else value == text


def _configuration_differs(made: Made, context: Context) -> bool | Unknown:
    same = _configuration_equals(made, context)
    return same if isinstance(same, Unknown) else not same


_CONDITIONS: Mapping[str, Callable[[Made, Context], bool | Unknown]] = {
    "IfCondition": _if,
    "UnlessCondition": _unless,
    "LaunchConfigurationEquals": _configuration_equals,
    "LaunchConfigurationNotEquals": _configuration_differs,
}


def _text(made: Made, _: Context) -> str | Unknown:
    value = made.get("text", "")
    return value if isinstance(value, str | Unknown) else str(value)


def _configuration(made: Made, context: Context) -> str | Unknown:
    name = perform(made.get("variable_name", ""), context)
    if isinstance(name, Unknown):
        return name
    context.used.add(name)
    if name in context.configurations:
        value = context.configurations[name]
        return value if isinstance(value, str | Unknown) else str(value)
    if "default" in made.values and made.get("default") is not None:
        return perform(made.get("default"), context)
    if isinstance(scope := context.configurations.get(ANY_NAME), Unknown):
        return scope
    raise DescriptionProblem(
        f"launch configuration '{name}' is used, but no argument of this name is declared before",
        "undeclared-argument",
        made.place("variable_name"),
        suggest(name, context.configurations) or f"declare it before: DeclareLaunchArgument('{name}')",
        name,
        INHERITED,
    )


def _join_path(made: Made, context: Context) -> str | Unknown:
    value: Any = made.get("substitutions")
    if isinstance(value, Unknown):
        return value
    parts = [value] if isinstance(value, (str, Made, PurePosixPath)) else list(value or ())
    texts = [perform(part, context) for part in parts]
    for text in texts:
        if isinstance(text, Unknown):
            return text
    joined = ""
    for text in map(str, texts):  # as os.path.join
        joined = text if text.startswith("/") else joined + ("" if not joined or joined.endswith("/") else "/") + text
    return joined


def _join_texts(made: Made, context: Context) -> str | Unknown:
    value: Any = made.get("substitutions")
    delimiter = perform(made.get("delimiter", ""), context)
    texts = (
        [perform(part, context) for part in value] if isinstance(value, (list, tuple)) else [perform(value, context)]
    )
    for text in (delimiter, *texts):
        if isinstance(text, Unknown):
            return text
    return str(delimiter).join(map(str, texts))


def _environment(made: Made, context: Context) -> str | Unknown:
    name = perform(made.get("name", ""), context)
    if isinstance(name, Unknown):
        return name
    if context.environment.get(name) is None and made.get("default_value") is not None:
        return perform(made.get("default_value"), context)
    return context.environment[name]


def _share(made: Made, context: Context) -> str | Unknown:
    return context.find_share(perform(made.get("package", ""), context), made.place("package"))


def _prefix(made: Made, context: Context) -> str | Unknown:
    return context.find_prefix(perform(made.get("package", ""), context), made.place("package"))


def _executable_in_package(made: Made, context: Context) -> str | Unknown:
    package, name = perform(made.get("package", ""), context), perform(made.get("executable", ""), context)
    prefix = context.find_prefix(package, made.span)
    for each in (prefix, name):
        if isinstance(each, Unknown):
            return each
    return f"{prefix}/lib/{package}/{name}"


def _find_executable(made: Made, context: Context) -> str | Unknown:
    name = perform(made.get("name", ""), context)
    if isinstance(name, Unknown):
        return name
    path = context.environment.get("PATH", "")
    context.budget.charge(PER_SYSTEM_CALL * (1 + path.count(":")))
    return shutil.which(name, path=path) or name


def _command(made: Made, context: Context) -> str | Unknown:
    text = perform(made.get("command", ""), context)
    if isinstance(text, Unknown) or context.run_command is None:
        return text if isinstance(text, Unknown) else Unknown(f"it is the output of '{text}'", made.span, "command")
    if LOG_FOLDER in text:
        return Unknown("the folder of the log is made when the launch starts", made.span)
    words, mode = split_command(text, context.budget), perform(made.get("on_stderr", "fail"), context)
    try:
        code, output, errors = run_with_files(words, context.environment, context.written, context.run_command)
    except (OSError, IndexError) as problem:
        reason = str(getattr(problem, "strerror", None) or problem).lower()
        message = f"'{text}' cannot be run: {reason}, expected a program that prints a value"
        raise DescriptionProblem(message, "bad-command", made.span, subject=text) from None
    if code or (errors and mode == "fail"):
        lines = errors.decode(errors="replace").strip().splitlines()[-1:]
        what = f"ended with exit code {code}" if code else "prints to standard error"
        message = f"'{text}' {what}, expected a value{''.join(f': {line}' for line in lines)}"
        help_ = "on_stderr='ignore' accepts such lines" if not code else f"run it alone: {text}"
        raise DescriptionProblem(message, "bad-command", made.span, help_, text)
    return (output + (errors if mode == "capture" else b"")).decode(errors="replace")


def _file(_: Made, context: Context) -> str:
    return context.file


def _folder(_: Made, context: Context) -> str:
    return context.folder


def _anonymous(made: Made, context: Context) -> str | Unknown:
    name = perform(made.get("name", ""), context)
    if isinstance(name, Unknown):
        return name
    key = f"anon {name}"
    return str(context.variables.setdefault(key, context.world.make_anonymous(name)))


def _flag_word(value: bool | Unknown) -> str | Unknown:
    return value if isinstance(value, Unknown) else str(value).lower()


def _logic(names: tuple[str, ...], combine: Callable[..., bool]) -> Callable[[Made, Context], str | Unknown]:
    def compute(made: Made, context: Context) -> str | Unknown:
        flags = [perform_flag(made.get(name), context, made, name) for name in names]
        for flag in flags:
            if isinstance(flag, Unknown):
                return flag
        return _flag_word(combine(*flags))

    return compute


def _many(combine: Callable[[list[bool]], bool]) -> Callable[[Made, Context], str | Unknown]:
    def compute(made: Made, context: Context) -> str | Unknown:
        values: Any = made.get("conditions", ())
        flags = [perform_flag(value, context, made, "conditions") for value in values]
        for flag in flags:
            if isinstance(flag, Unknown):
                return flag
        return _flag_word(combine([bool(flag) for flag in flags]))

    return compute


def _equals(made: Made, context: Context) -> str | Unknown:
    left, right = perform(_plain(made.get("left")), context), perform(_plain(made.get("right")), context)
    for each in (left, right):
        if isinstance(each, Unknown):
            return each
    if isinstance(made.get("left"), bool) or isinstance(made.get("right"), bool):
        left, right = str(left).lower(), str(right).lower()
    return _flag_word(left == right or _same_number(str(left), str(right)))


def _differs(made: Made, context: Context) -> str | Unknown:
    same = _equals(made, context)
    return same if isinstance(same, Unknown) else _flag_word(same == "false")


def _plain(value: object) -> object:
    return "" if value is None else value


def _same_number(left: str, right: str) -> bool:
    try:
        return float(left) == float(right)
    except ValueError:
        return False


def _if_else(made: Made, context: Context) -> str | Unknown:
    wanted = perform_flag(made.get("condition"), context, made, "condition")
    if isinstance(wanted, Unknown):
        return wanted
    return perform(made.get("if_value" if wanted else "else_value", ""), context)


def _content(made: Made, context: Context) -> str | Unknown:
    path = perform(made.get("path", ""), context)
    if isinstance(path, Unknown):
        return path
    try:
        return context.read(path).decode(errors="replace").replace("\r\n", "\n")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise DescriptionProblem(
            f"{path}: {reason}, expected a file", "missing-file", made.place("path"), subject=path
        ) from None


def _loop_value(made: Made, context: Context) -> str | Unknown:
    name = perform(made.get("name", ""), context)
    if isinstance(name, Unknown):
        return name
    if name in context.variables:
        return perform(context.variables[name], context)
    if made.get("default_value") is not None:
        return perform(made.get("default_value"), context)
    raise DescriptionProblem(
        f"no loop has the variable '{name}'", "undeclared-argument", made.place("name"), subject=name
    )


def _flag_configuration(made: Made, context: Context) -> str | Unknown:
    text = _configuration(
        Made("LaunchConfiguration", {"variable_name": made.get("name")}, made.span, made.places), context
    )
    if isinstance(text, Unknown):
        return text
    return "True" if text.lower() in ("true", "on", "yes", "1", "t", "y") else "False"


def _node_parameter(made: Made, context: Context) -> str | Unknown:
    name = perform(made.get("name", ""), context)
    if isinstance(name, Unknown):
        return name
    for source in context.global_parameters:
        for known, value in source.values if isinstance(source, ParameterValues) else ():
            if known == name:
                return str(tuple(value) if isinstance(value, list) else value)
    if made.get("default") is not None:
        return perform(made.get("default"), context)
    message = f"no global parameter is named '{name}', expected one of a SetParameter before"
    raise DescriptionProblem(message, "undeclared-argument", made.place("name"), None, name)


def split_command(text: str, budget: Budget) -> tuple[str, ...]:
    """Return the words of a command, as a shell would."""
    budget.charge(PER_YAML_CHARACTER * len(text) + len(text) ** 2 // 1000)  # shlex adds character to character
    try:
        return tuple(split_words(text))
    except ValueError:
        return (text,)


PERFORM: dict[str, Callable[[Made, Context], str | Unknown]] = {  # others add themselves
    "AllSubstitution": _many(all),
    "AndSubstitution": _logic(("left", "right"), lambda left, right: left and right),
    "AnonName": _anonymous,
    "AnySubstitution": _many(any),
    "BooleanSubstitution": _logic(("value",), bool),
    "Command": _command,
    "EnvironmentVariable": _environment,
    "EqualsSubstitution": _equals,
    "ExecutableInPackage": _executable_in_package,
    "FileContent": _content,
    "FindExecutable": _find_executable,
    "FindPackage": _prefix,
    "FindPackagePrefix": _prefix,
    "FindPackageShare": _share,
    "ForEachVar": _loop_value,
    "ForLoopIndex": _loop_value,
    "IfElseSubstitution": _if_else,
    "LaunchConfigAsBool": _flag_configuration,
    "LaunchConfiguration": _configuration,
    "LaunchLogDir": lambda *_: LOG_FOLDER,
    "LocalSubstitution": lambda made, _: Unknown("local values are known when the launch runs", made.span),
    "NotEqualsSubstitution": _differs,
    "NotSubstitution": _logic(("value",), lambda value: not value),
    "OrSubstitution": _logic(("left", "right"), lambda left, right: left or right),
    "ParameterSubstitution": _node_parameter,
    "PathJoinSubstitution": _join_path,
    "PathSubstitution": lambda made, context: perform(made.get("path"), context),
    "StringJoinSubstitution": _join_texts,
    "TextSubstitution": _text,
    "ThisLaunchFile": _file,
    "ThisLaunchFileDir": _folder,
}
