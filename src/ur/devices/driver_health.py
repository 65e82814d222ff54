"""Files that `ur doctor` reads: the health of a device as its driver sees it, and the commands that a mux refuses."""

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, TypeVar

from msgspec import Meta

from ur.source.foreign.json_values import BadJsonError, PrintableValue, read_json, write_json
from ur.source.replace import PRIVATE, replace_file
from ur.source.user_folders import runtime_folder

FOLDER = "ubiquity_launches/drivers"
OLD = 20.0  # s after which a file is that of a driver that no longer runs
_LONGEST = 4000
_MOST_FILES = 20

Text = Annotated[str, Meta(max_length=300)]
Record = TypeVar("Record", bound=PrintableValue)
Amount = Annotated[float, Meta(ge=0.0, lt=1e6)]
Share = Annotated[float, Meta(gt=-10.0, lt=10.0)]


class DriverHealth(PrintableValue, frozen=True):
    """A driver's device: its file and kind, whether it is open, and why not.

    `firmware` is its own account; `problem` why it cannot be used at all, `held` why its motors do not obey now.
    `frames` that were understood and `damaged` ones are per second, of the last seconds; `voltage` is that of its
    battery (V, 0.0: not measured), which is `empty` below what the base file says. `stops` says how the
    base stops when commands cease; it `drives_on` without a watchdog. `calibration` is the one of the robot file that a
    driver of a base or lidar uses.
    """

    device: Text
    kind: Text
    open: bool = False
    reason: Text = ""
    firmware: Text = ""
    problem: Text = ""
    held: Text = ""
    frames: Amount = 0.0
    damaged: Amount = 0.0
    voltage: Amount = 0.0
    empty: bool = False
    drives_on: bool = False
    stops: Text = ""
    calibration: Text = ""


class RefusedCommands(PrintableValue, frozen=True):
    """The commands that a mux refuses now, and what to do."""

    text: Text
    help: Text


class MotionRecord(PrintableValue, frozen=True):
    """The differences of a robot from its description that `metres` of driving have shown; 0.0: as described.

    The lidar by `yaw` (rad, counter-clockwise) and, in its own frame, `x` and `y` (m); the wheels' radius and
    separation by shares.
    """

    metres: Amount
    yaw: Share
    x: Share
    y: Share
    radius: Share
    separation: Share


def describe_errors(record: MotionRecord) -> str:
    """Describe the errors for users; '' for none."""
    turned, shifted = record.yaw, (record.x, record.y)
    side = "left" if turned > 0.0 else "right"
    parts = [f"the lidar is turned by {abs(math.degrees(turned)):.1f} degrees to the {side}"] if turned else []
    if any(shifted):
        parts.append("the lidar is {:+.3f} m ahead and {:+.3f} m to the left of its described place".format(*shifted))
    for value, more, less in (
        (record.radius, "larger", "smaller"),
        (record.separation, "farther apart", "nearer together"),
    ):
        if value:
            parts.append(f"the wheels are {abs(100.0 * value):.1f} % {more if value > 0.0 else less} than described")
    return "; ".join(parts)


OBSERVE_DRIVERS = f"""\
for f in "${{XDG_RUNTIME_DIR:-/run/user/$(id -u)}}/{FOLDER}"/*.json \
"${{XDG_STATE_HOME:-$HOME/.local/state}}/{FOLDER}"/*.json /run/ubiquity-*/{FOLDER}/*.json; do
[ ! -f "$f" ] || echo "$(($(date +%s) - $(stat -c %Y "$f"))) $(head -c {_LONGEST} "$f")"
done | head -n {_MOST_FILES}"""
"""The script that prints them: a line each, with its age in seconds."""


def parse_drivers(text: str) -> tuple[DriverHealth, ...]:
    """Read what the script printed, of drivers that run; what makes no sense is left out."""
    return parse_records(text, DriverHealth)


def parse_records(text: str, kind: type[Record]) -> tuple[Record, ...]:
    """Likewise for records of a kind."""
    found = []
    for line in text.splitlines()[:_MOST_FILES]:
        age, _, record = line.partition(" ")
        if not age.lstrip("-").isdecimal() or len(age) > 9 or int(age) > OLD:
            continue
        try:
            found.append(read_json(record, kind, _LONGEST))
        except BadJsonError:
            continue
    return tuple(found)


def health_file(node: str, environment: Mapping[str, str] = os.environ) -> Path:
    """Return the file of the driver that is a node of this name."""
    name = "".join(each if each.isalnum() or each in "_-" else "." for each in node.strip("/"))
    folder = environment.get("RUNTIME_DIRECTORY") or runtime_folder(environment)  # of a boot unit, never on the card
    return Path(folder, FOLDER, f"{name or 'driver'}.json")


def write_health(path: Path, health: PrintableValue) -> str:
    """Write a file in one step; return why that failed, '' where it did not."""
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(path, write_json(health), mode=PRIVATE, follow=False, lasting=False)
    except OSError as problem:
        return problem.strerror or str(problem)
    return ""
