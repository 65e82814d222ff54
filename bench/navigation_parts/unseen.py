"""Goals behind what no lidar sees: low boxes, glass, cables, hands on a bumper, in two rooms with one or two doors."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tests.ur_nodes.first_drive.drive import FirstDrive

from ur_nodes.ports.qualities import Quality

KINDS = ("low box", "glass", "cable", "hand")
BASES = ("stage", "create2:lidar", "stage:", "magni:lidar")  # the last two without a bumper
LIMIT, MOST_CONTACTS = 40.0, 3
_CELL, _SIZE, _WALL = 0.05, (8.0, 5.0), 4.0  # m; the wall between the rooms is at x = 4
_DOORS, _DOOR = (1.2, 3.4), 1.0  # m: y of their middles, their width
_START, _GOAL = (1.0, _DOORS[0]), (4.6, 0.0)  # m in the picture, and from the start


class _Drive(FirstDrive):
    """A first drive with a base whose bumpers navigation does not know."""

    def start(self, name: str) -> None:
        """Start a node."""
        for key in ("topics", "sectors"):
            self.bus.parameters[f"/move_base/local_costmap/bumper_layer/{key}"] = []
        super().start(name)


@dataclass(frozen=True, slots=True)
class Trial:
    """A trial: what is in the way, how the goal ended, after how many s, contacts, and how often the robot was lost."""

    name: str
    state: str
    text: str
    seconds: float
    contacts: int
    lost: int

    @property
    def good(self) -> bool:
        """Return whether it was reached or given up in time, with few contacts, and the robot never lost."""
        ended = self.state == "succeeded" or (
            self.state == "aborted" and ("lidar" in self.text or "stays" in self.text)
        )
        return ended and self.seconds <= LIMIT and self.contacts <= MOST_CONTACTS and not self.lost


def run_trial(number: int, folder: Path) -> Trial:
    """Send a robot to a goal in the other room; the number chooses base, obstacle, doors and places."""
    kind, base = KINDS[number % 4], BASES[number // 4 % 4]
    if kind == "hand" and base in BASES[2:]:  # they have no bumper
        kind = "low box"
    random = np.random.default_rng(number)
    name, _, variant = base.partition(":")
    world = _write_world(folder / f"unseen_{number}", kind, random, doors=1 + (number // 16 + number) % 2)
    drive = (_Drive if base in BASES[2:] else FirstDrive)(world, base=name, variant=variant, seed=number)
    contacts, lost = drive.record("simulator/collisions", int), drive.record("amcl/lost", str)
    id, began = drive.send_goal(*_GOAL), drive.bus.now
    if kind == "hand":
        assert drive.base.bumpers
        bumper = drive.client.publish(
            f"{drive.base.bumpers.topic}/{drive.base.bumpers.at[0].name}", bool, Quality.LATCHED
        )
        drive.bus.run(float(random.uniform(3.0, 6.0)))
        bumper.send(True)
        drive.bus.run(float(random.choice((0.5, 3.0, 20.0))))
        bumper.send(False)
    drive.bus.run_until(lambda: id in drive.states and drive.states[id].state not in ("pending", "active"), 3.0 * LIMIT)
    state, seconds = drive.states[id], (drive.bus.now - began) * 1e-9
    return Trial(
        f"{number} {kind}, {base}",
        state.state,
        state.text,
        seconds,
        contacts[-1] if contacts else 0,
        sum(map(bool, lost)),
    )


def _write_world(file: Path, kind: str, random: np.random.Generator, doors: int) -> Path:
    """Write a world file with its picture; the robot begins at the origin's door."""
    from PIL import Image

    cells = np.zeros((round(_SIZE[1] / _CELL), round(_SIZE[0] / _CELL)), bool)
    cells[:2] = cells[-2:] = True
    cells[:, :2] = cells[:, -2:] = True
    cells[:, round(_WALL / _CELL) : round(_WALL / _CELL) + 2] = True
    for door in _DOORS[:doors]:
        cells[round((door - _DOOR / 2) / _CELL) : round((door + _DOOR / 2) / _CELL), 2:-2] &= False
    for x, y in ((2.0, 4.6), (5.6, 0.2), (7.2, 3.0)):  # furniture, so that no two places look alike
        cells[round(y / _CELL) - 4 : round(y / _CELL) + 6, round(x / _CELL) : round(x / _CELL) + 8] = True
    Image.fromarray(np.where(cells[::-1], 0, 254).astype(np.uint8)).save(file.with_suffix(".png"))
    x, y = (_WALL + 0.05 - _START[0], 0.0) if kind == "glass" else random.uniform((1.2, -0.2), (3.0, 0.2)).tolist()
    size = {"low box": "[0.4, 0.4, 0.07]", "glass": f"[0.02, {_DOOR}, 2.0]", "cable": "[0.01, 1.2, 0.01]"}.get(kind)
    z = {"low box": 0.035, "glass": 1.0, "cable": 0.06}.get(kind)
    box = (
        f"boxes:\n  - {{name: unseen, pose: [{x}, {y}, {z}, 0], size: {size}, glass: {str(kind == 'glass').lower()}}}\n"
    )
    file.with_suffix(".yaml").write_text(
        f"image: {file.name}.png\nresolution: {_CELL}\norigin: [{-_START[0]}, {-_START[1]}, 0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n" + (box if size else "")
    )
    return file.with_suffix(".yaml")
