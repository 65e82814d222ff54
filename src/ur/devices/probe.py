"""Questions to devices that answer without changing their state: the script that asks, and its answers."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping, Sequence
from importlib.resources import files

from ur.devices.device import DeviceSnapshot
from ur.devices.known import KnownDevice, find_known
from ur.source.printable import printable

SECONDS = 3.0  # that one question may take


def list_questions(snapshot: DeviceSnapshot) -> list[tuple[str, str, int]]:
    """The questions worth asking: path, kind of question, baud rate. Devices in use are never asked."""
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
    """The shell command that asks them, one after the other, and prints a line of JSON: what each path answered."""
    program = (files(__package__) / "probe_program.py").read_text(encoding="utf-8")
    return shlex.join(["python3", "-I", "-c", program, json.dumps(questions)])


def parse_answers(output: str) -> Mapping[str, str]:
    """The answer of each path; '' where the answer makes no sense. Foreign text is made harmless."""
    from ur.source.foreign.json_values import BadJsonError, read_json

    try:
        answers = read_json(output.strip().rpartition("\n")[2], dict[str, str])
    except BadJsonError:
        return {}
    return {path: printable(text)[:200] for path, text in answers.items()}
