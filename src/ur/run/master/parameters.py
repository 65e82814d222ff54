"""Parameters of a plan as values, including those that a program prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ur.launchfile.plan.specs import ParamSpec, ParamValue, Plan
from ur.launchfile.plan.values.convert import convert_scalar
from ur.run.master.client import Master
from ur.run.master.xml_rpc import CallRefused, Unanswered, dump_value
from ur.run.supervisor.events import Event, ParametersSet, SetupFailed, Unregistered
from ur.source.arguments import split_words
from ur.source.diagnostic import UserError, user_error, user_error_about

if TYPE_CHECKING:
    import subprocess


class CommandParameters:
    """The programs of `<param command=...>`, all running at once. Created by `start_commands`."""

    def __init__(self, running: list[tuple[ParamSpec, subprocess.Popen[bytes]]]) -> None:
        self._running = running

    def collect(self) -> dict[str, ParamValue]:
        """Wait for all programs and return the values by name. Raises UserError: a program failed, or a wrong type."""
        return {spec.name: _convert(spec, *_finish(process)) for spec, process in self._running}

    def stop(self) -> None:
        """End the programs that are still running."""
        for _, process in self._running:
            if process.poll() is None:
                process.kill()
                process.wait()


def start_commands(specs: Sequence[ParamSpec], environment: Mapping[str, str]) -> CommandParameters:
    """Start the programs that print a parameter's value. Raises UserError if one cannot be started."""
    started = CommandParameters([])
    running = []
    for spec in specs:
        if spec.command is None:
            continue
        import subprocess  # few plans have such parameters

        try:
            process = subprocess.Popen(
                split_words(spec.command),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                env=environment,
                start_new_session=True,
            )
        except (OSError, ValueError, IndexError) as problem:
            started.stop()
            reason = str(getattr(problem, "strerror", None) or problem).lower()
            raise user_error(
                f"{spec.name}: {spec.command!r} cannot be run: {reason}", spec.origin.span, rule="bad-command"
            ) from None
        running.append((spec, process))
        started = CommandParameters(running)
    return started


def check_sendable(specs: Sequence[ParamSpec]) -> None:
    """Raise UserError for the first value that a parameter server cannot hold."""
    for spec in specs:
        if spec.command is None:
            try:
                dump_value(spec.value)
            except ValueError as problem:
                raise user_error(f"{spec.name}: {problem}", spec.origin.span, rule="bad-parameter") from None


def _finish(process: subprocess.Popen[bytes]) -> tuple[bytes, bytes, int]:
    out, err = process.communicate()
    return out, err, process.returncode


def _convert(spec: ParamSpec, out: bytes, err: bytes, code: int) -> ParamValue:
    if code != 0:
        last = err.decode("utf-8", "replace").strip().splitlines()[-1:]
        raise user_error(
            f"{spec.name}: {spec.command!r} ended with exit code {code}" + "".join(f": {line}" for line in last),
            spec.origin.span,
            rule="bad-command",
        )
    text = out.decode("utf-8", "replace")
    try:
        return _parse_yaml(text) if spec.command_type == "yaml" else convert_scalar(text, spec.command_type)
    except ValueError as problem:
        raise user_error(
            f"{spec.name}: what {spec.command!r} printed: {problem}", spec.origin.span, rule="bad-command"
        ) from None


def _parse_yaml(text: str) -> ParamValue:
    from ur.source.foreign.yaml_text import load_yaml  # imported late: only if a command prints YAML

    found: ParamValue = load_yaml(text)
    return found


def upload_parameters(
    plan: Plan, master: Master, extra: Mapping[str, ParamValue], commands: CommandParameters
) -> Event:
    """Set the parameters of a plan, `extra` ones before them, and return the event that follows."""
    try:
        _set_parameters(plan, master, extra, commands)
    except UserError as problem:
        return SetupFailed(str(problem))
    except (Unanswered, CallRefused, ValueError) as problem:
        return SetupFailed(f"parameters cannot be set on the master at {master.uri}: {problem}")
    return ParametersSet()


def _set_parameters(plan: Plan, master: Master, extra: Mapping[str, ParamValue], commands: CommandParameters) -> None:
    for each in plan.commands:
        if each.command == "dump":
            _dump_parameters(master, each.name, each.file or "")
        else:
            try:
                master.call("deleteParam", each.name)
            except CallRefused:
                continue  # the parameter does not exist
    values = {spec.name: spec.value for spec in plan.params if spec.command is None}
    printed = commands.collect()
    ordered = {spec.name: printed[spec.name] if spec.name in printed else values[spec.name] for spec in plan.params}
    master.set_parameters({**extra, **ordered}, plan.clear_params)


def _dump_parameters(master: Master, name: str, file: str) -> None:
    import yaml  # only for <rosparam command="dump">

    try:
        Path(file).write_text(yaml.safe_dump(master.call("getParam", name)), encoding="utf-8")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error_about(file, f"parameters cannot be written: {reason}", rule="bad-dump") from None


def remove_registrations(master: Master, names: list[str]) -> Event:
    """Unregister nodes from the master that did not do so themselves."""
    with suppress(Unanswered, CallRefused):  # a master that has ended has no registrations
        master.remove_dead_nodes(names)
    return Unregistered()
