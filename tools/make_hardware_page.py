"""Make docs/reference/hardware.md of `tools/hardware.yaml`, the table of known devices and the bases."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import yaml

from ur.devices.known import find_rows

ROOT = Path(__file__).resolve().parents[1]
TABLE = ROOT / "tools" / "hardware.yaml"
PAGE = ROOT / "docs" / "reference" / "hardware.md"
_HEAD = """# Robots and sensors

Made by `tools/make_hardware_page.py`: edit `tools/hardware.yaml` or the table of known devices instead.

Nobody has tried any of this on the hardware itself.
*Stand-in* means that, in a test, a program speaks the device's public protocol or stands for its interface.
*Simulator* means that the simulated robot was tried, not its drivers.
*Description* means that a test reads a description of this kind; the makers' own description is in no test.
*Drives* were made once, with `bench/navigation`, by the base that `ur new base` wrote.
What no test tries is in the last column; `tools/hardware.yaml` names each test.
On ROS 1 a robot with navigation takes about 280 MB of memory, 335 with the page; without navigation and black box 170.
The page takes 15 MB more if it starts 30 s or more after the nodes, or before a program that boot services run.
See [find devices](../how-to/devices.md) for their names, and [get packages](../how-to/get-packages.md) for drivers.

## What one command brings

"""


@dataclass(frozen=True, slots=True)
class Trial:
    """Something that was tried: in which way, and the test that does it, as FILE::FUNCTION of the repository."""

    way: str
    subject: str
    test: str


@dataclass(frozen=True, slots=True)
class Supported:
    """A robot or sensor; the table explains the fields."""

    name: str
    command: str
    brings: str
    by_hand: str
    untried: str
    devices: tuple[str, ...] = ()
    bases: tuple[str, ...] = ()
    trials: tuple[Trial, ...] = ()
    drives: str = ""


def read_table() -> list[Supported]:
    """The table of robots and sensors."""
    rows = yaml.safe_load(TABLE.read_text(encoding="utf-8"))
    return [Supported(**{**row, "trials": tuple(Trial(**each) for each in row.get("trials", ()))}) for row in rows]


def make_page() -> str:
    """The page as Markdown."""
    supported = read_table()
    rows = [
        (each.name, each.command, each.brings, each.by_hand, _tell_trials(each), each.untried) for each in supported
    ]
    heads = ("robot or sensor", "command", "what it brings", "left to do by hand", "tried", "not tried")
    known = [(each.name, _list_bases(each), _list_devices(each)) for each in supported if each.devices or each.bases]
    parts = [_HEAD, _table(heads, rows), "\n## How they are known\n\n"]
    parts += [_table(("robot or sensor", "base files", "USB id or device: stable name"), known)]
    return "".join(parts)


def _ways(each: Supported) -> list[str]:
    return list(dict.fromkeys(trial.way for trial in each.trials))


def _tell_trials(each: Supported) -> str:
    return "; ".join([*_ways(each), *([f"drives: {each.drives}"] if each.drives else [])]) or "not tried"


def _list_bases(each: Supported) -> str:
    return ", ".join(f"`{base}`" for base in each.bases) or "none"


def _list_devices(each: Supported) -> str:
    rows = [row for name in each.devices for row in find_rows(name)]
    names = [
        f"`{row.match}`" + (f": `/dev/{row.stable}`" if row.stable else "") + ("" if row.sure else " (a guess)")
        for row in rows
    ]
    return ", ".join(names) or "none"


def _table(heads: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [heads, tuple("---" for _ in heads), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


if __name__ == "__main__":
    PAGE.write_text(make_page(), encoding="utf-8")
