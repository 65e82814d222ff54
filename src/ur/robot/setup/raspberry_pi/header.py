"""The serial line and the I2C bus on the header of a Raspberry Pi, for a base whose devices are behind them.

Sources: Raspberry Pi's documentation, "Configure UARTs" and config.txt, and the README of its overlays. Up to the Pi 4
the line that keeps its speed (`/dev/ttyAMA0`) belongs to Bluetooth, until `disable-bt` gives it to the header; a Pi 5
has it free. The console of the kernel leaves it, too.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from ur.devices.known import Expected
from ur.robot.setup.change import Change, ChangeScript, show_difference
from ur.robot.setup.engine import apply_change, gather_facts, plan_undo
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.wanted import Wanted, WantedFile, write_file
from ur.robot.ssh.shell import Shell

SERIAL, I2C = "/dev/ttyAMA0", "/dev/i2c-1"
BEHIND = (Expected("base", "serial", SERIAL), Expected("imu", "i2c", I2C))
"""Devices behind the header."""
MODULES = "/etc/modules-load.d/ubiquity-i2c.conf"
MODEL = "/proc/device-tree/model"
FOLDERS = ("/boot/firmware", "/boot")  # the first is that of Debian 12 and Ubuntu; the second then has a stub
FILES = frozenset({MODEL, *(f"{folder}/{name}" for folder in FOLDERS for name in ("config.txt", "cmdline.txt"))})
_HEAD = "# Written by ur robot setup: the serial line of the header, for the motor board."
_I2C_HEAD = "# Written by ur robot setup: the I2C bus of the header."
_CONSOLE = re.compile(r"(?:^|(?<=[ \n]))console=(?:serial0|ttyAMA0|ttyS0)(?:,[0-9a-z]{1,12})? ?")
_LOAD = "modprobe i2c-dev 2>/dev/null || :"
_KEPT = "# cmdline.txt had: "
_HEADER_LINES = {"enable_uart=1": ("enable_uart=1",), "dtoverlay=disable-bt": ("dtoverlay=disable-bt",
    "dtoverlay=miniuart-bt", "dtoverlay=pi3-disable-bt", "dtoverlay=pi3-miniuart-bt")}  # fmt: skip
_HEADER_LINES_5 = {"dtparam=uart0=on": ("dtparam=uart0=on", "dtparam=uart0", "dtoverlay=uart0-pi5")}
_I2C_LINES = {"dtparam=i2c_arm=on": ("dtparam=i2c_arm=on", "dtparam=i2c_arm", "dtparam=i2c=on", "dtparam=i2c")}


@dataclass(frozen=True, slots=True)
class WantedHeader:
    """The serial line is on the header and nothing else uses it; the I2C bus is. It takes effect with the next boot."""

    folder: str
    model: str
    serial: bool = False
    i2c: bool = False
    title: str = "header of the Raspberry Pi"

    def request(self, user: str) -> FactsRequest:
        """The two files of the firmware."""
        return FactsRequest(user, files=frozenset({f"{self.folder}/config.txt", f"{self.folder}/cmdline.txt"}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Add what is missing in config.txt, and take the console out of cmdline.txt, which is kept as a comment."""
        config, command = self._texts(facts)
        new, left = config, command
        if self.serial:
            consoles = [each.strip() for each in _CONSOLE.findall(command)]
            kept = [_KEPT + " ".join(consoles)] if consoles else []
            left = _CONSOLE.sub("", command)
            new = _append(new, _HEAD, [*kept, *list_missing(config, self.model)])
        if self.i2c:
            new = _append(new, _I2C_HEAD, _list_absent(config, _I2C_LINES))
        return self._change(facts, config, new, command, left) if (new, left) != (config, command) else None

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Take the lines away, and put the console back."""
        config, command = self._texts(facts)
        new, restored = config.replace(_append("", _I2C_HEAD, _I2C_LINES), ""), command
        if _HEAD in new.split("\n"):
            before, _, block = new.partition(f"{_HEAD}\n")
            rows = block.split("\n")
            consoles = " ".join(row.removeprefix(_KEPT) for row in rows if row.startswith(_KEPT))
            ours = {_HEAD, *_HEADER_LINES, *_HEADER_LINES_5}
            end = next((at for at, row in enumerate(rows) if not _is_ours(row, ours)), len(rows))
            restored = f"{consoles} {command}" if consoles else command
            new = before + "\n".join(rows[end:])
        return self._change(facts, config, new, command, restored) if new != config else None

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


def want_header(facts: ComputerFacts, devices: Iterable[Expected]) -> list[Wanted]:
    """The wanted states for a base whose devices are behind the header of a Raspberry Pi; nothing for others."""
    model = (facts.file(MODEL).text or "").replace("\0", "")
    paths = {each.path for each in devices}
    wanted: list[Wanted] = []
    if I2C in paths:  # also on other computers
        wanted.append(WantedFile("module of I2C buses", MODULES, "i2c-dev\n", then=_LOAD))
    folder = next((each for each in FOLDERS if facts.file(f"{each}/config.txt").text is not None), None)
    if folder is None or "Raspberry Pi" not in model:
        return wanted
    if SERIAL in paths or I2C in paths:
        wanted.append(WantedHeader(folder, model, serial=SERIAL in paths, i2c=I2C in paths))
    return wanted


def list_missing(config: str, model: str) -> list[str]:
    """List the lines that a config.txt lacks, for this model; a line for other models alone does not count."""
    is_5 = re.search(r"Raspberry Pi (5|Compute Module 5|500)", model)
    return _list_absent(config, _HEADER_LINES_5 if is_5 else _HEADER_LINES)


def _append(config: str, head: str, rows: Iterable[str]) -> str:
    """The text with a block of lines, where there are some."""
    lines = [*rows]
    if not lines:
        return config
    block = "\n".join([head, "[all]", *lines]) + "\n"
    return config + ("" if config.endswith("\n") or not config else "\n") + block


def _list_absent(config: str, wanted: Mapping[str, tuple[str, ...]]) -> list[str]:
    """The lines that apply to all models and are missing, also by their other names."""
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


def undo_header(
    shell: Shell,
    user: str,
    report: Callable[[str], None],
    look: Callable[..., ComputerFacts] = gather_facts,
    apply: Callable[[Shell, Change], None] = apply_change,
) -> int:
    """Give the header back to Bluetooth and the console, without its I2C bus; return the number of changes.

    The base does not matter: the set-up may have been for another one. Raises UserError.
    """
    base = FactsRequest(user, files=FILES)
    items = want_header(look(shell, (), user, base, root=True), BEHIND)
    changes = plan_undo(items, look(shell, items, user, base, root=True))
    for change in changes:
        report(f"{change.title}: taken back" + (f", {change.note}" if change.note else ""))
        apply(shell, change)
    return len(changes)
