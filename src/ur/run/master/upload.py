"""Upload of a run's parameters to the master, and removal of the run's registrations at its end."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from ur.launchfile.plan.specs import ParamValue, Plan
from ur.run.master.client import Master
from ur.run.master.parameters import CommandParameters, plain_values
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.supervisor.events import Event, ParametersSet, SetupFailed, Unregistered
from ur.source.diagnostic import UserError, error_about


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
    values = plain_values(plan.params)
    printed = commands.collect()
    ordered = {spec.name: printed[spec.name] if spec.name in printed else values[spec.name] for spec in plan.params}
    master.set_parameters({**extra, **ordered}, plan.clear_params)


def _dump_parameters(master: Master, name: str, file: str) -> None:
    import yaml  # only for <rosparam command="dump">

    try:
        Path(file).write_text(yaml.safe_dump(master.call("getParam", name)), encoding="utf-8")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error_about(file, f"parameters cannot be written: {reason}", rule="bad-dump")) from None


def remove_registrations(master: Master, names: list[str]) -> Event:
    """Unregister nodes from the master that did not do so themselves."""
    with suppress(Unanswered, CallRefused):  # a master that has ended has no registrations
        master.remove_dead_nodes(names)
    return Unregistered()
