"""A plan as JSON: the output of `ur launch --dump json`, which tests compare with roslaunch."""

import base64
from collections.abc import Sequence

from ur.launchfile.plan.commands import CommandRunner, refuse_command, run_commands
from ur.launchfile.plan.specs import NodeSpec, Origin, ParamValue, Plan, describe_trigger
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span


def dump_plan(plan: Plan, *, with_origins: bool = False, run: CommandRunner = refuse_command) -> dict[str, object]:
    """Return a plan as plain values, to be printed with sorted keys.

    `run` runs the programs of `<param command=...>`, as roslaunch does while it loads. When roslaunch would refuse the
    file: `{"ok": False, "error": message, "diagnostics": [...]}`. Binary parameters are base64, dates texts; numbers
    outside of JSON (`.inf`, `.nan`) stay numbers, which Python's json module supports. With origins, `origins` has the
    position and the including positions of every `nodes/NAME`, `tests/NAME`, `params/NAME` and `machines/NAME`.
    """
    plan = run_commands(plan, run)
    errors = [found for found in plan.diagnostics if found.severity is Severity.ERROR]
    if errors:
        return dump_refusal(plan.diagnostics)
    dumped: dict[str, object] = {
        "ok": True,
        "nodes": sorted((_dump_node(node) for node in plan.nodes), key=lambda node: str(node["name"])),
        "tests": sorted(
            (
                {
                    **_dump_node(test.node),
                    "test_name": test.test_name,
                    "time_limit": test.time_limit,
                    "retry": test.retry,
                }
                for test in plan.tests
            ),
            key=lambda test: (str(test["name"]), str(test["test_name"])),
        ),
        "params": {param.name: plain_value(param.value) for param in plan.params},
        "clear_params": sorted(plan.clear_params),
        "machines": {
            machine.name: {
                "address": machine.address,
                "user": machine.user,
                "env_loader": machine.env_loader,
                "ssh_port": machine.ssh_port,
                "timeout": machine.timeout,
            }
            for machine in plan.machines
        },
        "files": sorted(plan.files),
    }
    if with_origins:
        dumped["origins"] = _dump_origins(plan)
    return dumped


def dump_refusal(diagnostics: Sequence[Diagnostic]) -> dict[str, object]:
    """Return the dump of a file that roslaunch would refuse: at least one finding is an error; the first is named."""
    first = next(found for found in diagnostics if found.severity is Severity.ERROR)
    message = f"{first.span}: {first.message}" if first.span else first.message
    return {"ok": False, "error": message, "diagnostics": [_dump_diagnostic(found) for found in diagnostics]}


def plain_value(value: ParamValue) -> object:
    """Return a parameter's value in JSON's types."""
    if isinstance(value, bool | int | float | str) or value is None:
        return value
    if isinstance(value, bytes):
        return base64.b64encode(value).decode("ascii")
    if isinstance(value, list):
        return [plain_value(item) for item in value]
    if isinstance(value, dict):
        return {_plain_key(key): plain_value(item) for key, item in value.items()}
    if isinstance(value, set):
        return sorted((plain_value(item) for item in value), key=str)
    return str(value)


def _plain_key(key: object) -> str:
    # As JSON's own writer does it, which cannot sort keys of several types.
    if key is None:
        return "null"
    return str(key).lower() if isinstance(key, bool) else str(key)


def _dump_node(node: NodeSpec) -> dict[str, object]:
    more: dict[str, object] = {"kind": node.kind} if node.kind != "node" else {}
    more |= {"container": node.container} if node.container else {}
    more |= {"starts": describe_trigger(node.trigger)} if node.trigger is not None else {}
    return {
        **more,
        "name": node.full_name if node.name else None,
        "package": node.package,
        "type": node.type,
        "args": " ".join(node.args.split()),
        "machine": node.machine,
        "respawn": node.respawn,
        "respawn_delay": node.respawn_delay,
        "required": node.required,
        "output": node.output,
        "cwd": node.cwd,
        "launch_prefix": node.launch_prefix,
        "remaps": sorted([source, target] for source, target in node.remaps),
        "env": dict(node.env),
    }


def _dump_diagnostic(found: Diagnostic) -> dict[str, object]:
    return {
        "severity": found.severity.value,
        "rule": found.rule,
        "message": found.message,
        "place": _dump_place(found.span) if found.span else None,
        "notes": [
            {"message": note.message, "place": _dump_place(note.span) if note.span else None} for note in found.notes
        ],
        "help": found.help,
    }


def _dump_origins(plan: Plan) -> dict[str, dict[str, object]]:
    origins = {f"nodes/{node.full_name}": _dump_origin(node.origin) for node in plan.nodes}
    origins.update((f"tests/{test.node.full_name}", _dump_origin(test.node.origin)) for test in plan.tests)
    origins.update((f"params/{param.name}", _dump_origin(param.origin)) for param in plan.params)
    origins.update((f"machines/{machine.name}", _dump_origin(machine.origin)) for machine in plan.machines)
    return origins


def _dump_origin(origin: Origin) -> dict[str, object]:
    return {**_dump_place(origin.span), "includes": [_dump_place(step) for step in origin.includes]}


def _dump_place(span: Span) -> dict[str, object]:
    line, column = span.position
    return {"file": span.file.path, "line": line, "column": column}
