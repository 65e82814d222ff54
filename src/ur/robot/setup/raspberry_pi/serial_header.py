"""The serial line on the header of a Raspberry Pi, for a base whose motor board is behind it, as a Magni's.

Sources: Raspberry Pi's documentation, "Configure UARTs", and the README of its overlays. Up to the Pi 4 the line that
keeps its speed (`/dev/ttyAMA0`) belongs to Bluetooth, until `disable-bt` gives it to the header; a Pi 5 has it free.
The console of the kernel leaves it, too.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from ur.devices.device import Expected
from ur.robot.setup.change import Change, ChangeScript, show_difference
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.wanted import write_file

DEVICE = "/dev/ttyAMA0"
MODEL = "/proc/device-tree/model"
FOLDERS = ("/boot/firmware", "/boot")  # the first is that of Debian 12 and Ubuntu; the second then has a stub
FILES = frozenset({MODEL, *(f"{folder}/{name}" for folder in FOLDERS for name in ("config.txt", "cmdline.txt"))})
_HEAD = "# Written by ur robot setup: the serial line of the header, for the motor board."
_CONSOLE = re.compile(r"(?:^|(?<=[ \n]))console=(?:serial0|ttyAMA0|ttyS0)(?:,[0-9a-z]{1,12})? ?")
_KEPT = "# cmdline.txt had: "
_HEADER_LINES = {"enable_uart=1": ("enable_uart=1",), "dtoverlay=disable-bt": ("dtoverlay=disable-bt",
    "dtoverlay=miniuart-bt", "dtoverlay=pi3-disable-bt", "dtoverlay=pi3-miniuart-bt")}  # fmt: skip
_HEADER_LINES_5 = {"dtparam=uart0=on": ("dtparam=uart0=on", "dtparam=uart0", "dtoverlay=uart0-pi5")}


@dataclass(frozen=True, slots=True)
class WantedSerialHeader:
    """The line is on the header, and nothing else uses it. It takes effect with the next boot."""

    folder: str
    model: str
    title: str = "serial line of the header"

    def request(self, user: str) -> FactsRequest:
        """The two files of the firmware."""
        return FactsRequest(user, files=frozenset({f"{self.folder}/config.txt", f"{self.folder}/cmdline.txt"}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Add what is missing in config.txt, and take the console out of cmdline.txt, which is kept as a comment."""
        config, command = self._texts(facts)
        consoles = [each.strip() for each in _CONSOLE.findall(command)]
        missing = list_missing(config, self.model)
        if not missing and not consoles:
            return None
        rows = [*([_KEPT + " ".join(consoles)] if consoles else []), *missing]
        block = "\n".join([_HEAD, "[all]", *rows]) + "\n"
        new = config + ("" if config.endswith("\n") or not config else "\n") + block
        return self._change(facts, config, new, command, _CONSOLE.sub("", command))

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Take the lines away, and put the console back."""
        config, command = self._texts(facts)
        if _HEAD not in config.split("\n"):
            return None
        ours = {_HEAD, *_HEADER_LINES, *_HEADER_LINES_5}
        before, _, block = config.partition(f"{_HEAD}\n")
        rows = block.split("\n")
        consoles = " ".join(row.removeprefix(_KEPT) for row in rows if row.startswith(_KEPT))
        end = next((at for at, row in enumerate(rows) if not _is_ours(row, ours)), len(rows))
        restored = f"{consoles} {command}" if consoles else command
        return self._change(facts, config, before + "\n".join(rows[end:]), command, restored)

    def _texts(self, facts: ComputerFacts) -> tuple[str, str]:
        config, command = (facts.file(f"{self.folder}/{name}").text for name in ("config.txt", "cmdline.txt"))
        return config or "", command or ""

    def _change(self, facts: ComputerFacts, config: str, new: str, command: str, restored: str) -> Change:
        scripts: list[ChangeScript] = []
        differences: list[str] = []
        for name, before, after in (("config.txt", config, new), ("cmdline.txt", command, restored)):
            path = f"{self.folder}/{name}"
            if before != after:
                scripts.append(write_file(facts, path, after, facts.file(path).mode))
                differences.append(show_difference(path, before, after))
        return Change(self.title, "\n".join(differences), tuple(scripts), note="from the next boot on")


def want_serial_header(facts: ComputerFacts, devices: Iterable[Expected]) -> list[WantedSerialHeader]:
    """The wanted state for a base whose board is behind the header of a Raspberry Pi; nothing for others."""
    model = (facts.file(MODEL).text or "").replace("\0", "")
    if "Raspberry Pi" not in model or not any(each.path == DEVICE for each in devices):
        return []
    folder = next((each for each in FOLDERS if facts.file(f"{each}/config.txt").text is not None), None)
    return [WantedSerialHeader(folder, model)] if folder else []


def list_missing(config: str, model: str) -> list[str]:
    """List the lines that a config.txt lacks, for this model; a line for other models alone does not count."""
    wanted = _HEADER_LINES_5 if re.search(r"Raspberry Pi (5|Compute Module 5|500)", model) else _HEADER_LINES
    general, section = set[str](), "all"
    for line in config.splitlines():
        text = line.split("#")[0].strip()
        if text.startswith("["):
            section = text.strip("[]")
        elif section == "all":
            general.add(text)
    return [line for line, same in wanted.items() if not general.intersection(same)]


def _is_ours(row: str, lines: Iterable[str]) -> bool:
    return row in lines or row == "[all]" or row.startswith(_KEPT)
