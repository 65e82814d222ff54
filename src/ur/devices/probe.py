"""Queries to devices that answer without changing their state: the script that sends them, and its answers."""

import json
import shlex
from collections.abc import Mapping, Sequence
from importlib.resources import files

from ur.devices.known import DeviceSnapshot, KnownDevice, find_known
from ur.source.printable import printable

SECONDS = 3.0  # that one question may take


def list_questions(snapshot: DeviceSnapshot) -> list[tuple[str, str, int]]:
    """Return the useful queries: path, kind of query, baud rate. Devices in use are never queried."""
    found = []
    for device in snapshot.devices:
        rows: Sequence[KnownDevice] = find_known(device)
        found += [
            (device.path, row.probe, row.baud)
            for row in rows
            if row.probe and device.allowed and not device.holders and device.kind == "serial"
        ]
    return found


def probe_script(questions: Sequence[tuple[str, str, int]]) -> str:
    """Return the shell command that sends the queries one after the other, and prints the answers as JSON."""
    program = (files(__package__) / "probe_program.py").read_text(encoding="utf-8")
    return shlex.join(["python3", "-I", "-c", program, json.dumps(questions)])


def parse_answers(output: str) -> Mapping[str, str]:
    """Return the answer of each path; '' if it is invalid. Untrusted text is escaped."""
    from ur.source.foreign.json_values import BadJsonError, read_json

    try:
        answers = read_json(output.strip().rpartition("\n")[2], dict[str, str])
    except BadJsonError:
        return {}
    return {path: printable(text)[:200] for path, text in answers.items()}
