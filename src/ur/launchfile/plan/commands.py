"""`<param command=...>`: execution of the programs whose output is a parameter, if the caller wants it."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol

from ur.launchfile.plan.specs import ParamSpec, ParamValue, Plan
from ur.launchfile.plan.values.convert import convert_scalar
from ur.launchfile.plan.values.yaml_values import YamlProblem, read_yaml
from ur.source.arguments import split_words
from ur.source.diagnostic import Diagnostic, Note, error

MAX_OUTPUT = 64 * 1024 * 1024


class CommandResult(NamedTuple):
    """The exit code and the standard output of a command."""

    code: int
    output: bytes


class CommandRunner(Protocol):
    """Runs one program to its end."""

    def __call__(self, words: Sequence[str]) -> CommandResult:
        """Return the result of a command line. Raises OSError if it cannot be started."""
        ...


def run_command(words: Sequence[str], most: int = MAX_OUTPUT) -> CommandResult:
    """Run a program on this computer; its standard error is that of this process, as in roslaunch.

    Raises OSError for a program that cannot be started or prints more than `most` bytes.
    """
    import subprocess  # 6 ms that most launch files do not need

    with subprocess.Popen(list(words), stdout=subprocess.PIPE, stdin=subprocess.DEVNULL) as process:
        assert process.stdout is not None
        try:
            output = process.stdout.read(most + 1)
        except BaseException:
            process.kill()
            raise
        if len(output) > most:
            process.kill()
            raise OSError(0, f"prints more than {most:,} bytes", words[0])
    return CommandResult(process.returncode, output)


def run_with(words: Sequence[str], environment: Mapping[str, str]) -> tuple[int, bytes, bytes]:
    """Return exit code, standard output and standard error of a program in an environment. Raises OSError."""
    import subprocess  # as above

    done = subprocess.run(
        list(words), env=dict(environment), stdin=subprocess.DEVNULL, capture_output=True, check=False
    )
    return done.returncode, done.stdout, done.stderr


RunWith = Callable[[Sequence[str], Mapping[str, str]], tuple[int, bytes, bytes]]


def refuse_command(words: Sequence[str]) -> CommandResult:
    """Refuse to run a command. Raises OSError."""
    raise PermissionError(1, "programs are not run here", words[0])


def run_commands(plan: Plan, run: CommandRunner) -> Plan:
    """Return the plan with the values of parameters that programs print. Equal commands run once.

    A program that fails, or prints an invalid value, adds an error to the plan's diagnostics.
    """
    if not plan.programs:
        return plan
    results: dict[str, CommandResult | str] = {}
    diagnostics = list(plan.diagnostics)
    values: dict[tuple[str, str], ParamValue] = {}
    for param in plan.programs:
        command = param.command or ""
        if command not in results:
            results[command] = _run(command, run)
        try:
            values[command, param.command_type] = _read(results[command], param)
        except ValueError as problem:
            diagnostics.append(_explain(param, str(problem)))
    params = tuple(
        param._replace(value=values.get((param.command, param.command_type)), command=None)
        if param.command is not None
        else param
        for param in plan.params
    )
    return plan._replace(params=params, diagnostics=tuple(diagnostics), programs=())


def _run(command: str, run: CommandRunner) -> CommandResult | str:
    # A text is the reason for a missing result.
    try:
        words = split_words(command)
    except ValueError as problem:
        return f"the command cannot be split into words: {problem}"
    if not words:
        return "the command is empty"
    try:
        return run(words)
    except (OSError, ValueError) as problem:
        return f"{words[0]}: {(getattr(problem, 'strerror', None) or str(problem)).lower()}"


def _read(result: CommandResult | str, param: ParamSpec) -> ParamValue:
    if isinstance(result, str):
        raise ValueError(result)
    if result.code != 0:
        raise ValueError(f"the command ended with code {result.code}, expected 0")
    text = result.output.decode("utf-8")
    if param.command_type != "yaml":
        return convert_scalar(text, param.command_type)
    try:
        return read_yaml(text, reads_angles=True).value
    except YamlProblem as problem:
        raise ValueError(f"what it prints is not valid YAML: {problem}") from None


def _explain(param: ParamSpec, reason: str) -> Diagnostic:
    steps = tuple(Note("included from here", step) for step in reversed(param.origin.includes))
    return error(
        f"parameter {param.name} has no value: {reason}",
        param.origin.span,
        rule="param-command",
        notes=steps,
        help=f"run it by hand to see more: {param.command}",
    )
