"""Make docs/reference/releases.md, and the table of releases in README.md, from src/ur/system/releases.tsv.

A test compares the committed texts with this.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from ur.system.releases import Release, load_releases

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "reference" / "releases.md"
README = ROOT / "README.md"
BEGIN, END = "<!-- releases: made by tools/make_releases_page.py -->", "<!-- releases: end -->"
_STAND_IN = "a Debian 12 without packages of ROS, under the name of Ubuntu 24.04"  # tests/fresh/run --only brought
_HEAD = """\
# Releases

Made by `tools/make_releases_page.py`: edit `src/ur/system/releases.tsv` instead.

The project uses ROS 1 from the distribution's own packages, on x86-64 or arm64, where there are any.
A release that packages it can be the system of your computer and of a robot.
On a release that does not, nodes run on your own ROS 2 from `/opt/ros` (Jazzy or later).
Without it, they run on x86-64 on [ROS 2 as Python packages](../how-to/ros2.md#which-ros-2), installed without `sudo`.
Without it on arm64, all nodes of a run are in one process, [without ROS](../how-to/ros2.md#without-ros).
After `ur use sim --ros 1`, ROS 1 runs there on either in a Debian 13 root that the project makes.
`ur image prepare` refuses such a system, and `ur robot setup` takes it where the robot has ROS 2.

A derivative counts as the release that it is made from: Linux Mint 22 as Ubuntu 24.04, LMDE 7 as Debian 13.
Derivatives are expected to work, but were not tried.

"""
_FOOT = f"""
The column "lists" has the date of the look-up in the release's package lists, made with `tools/check_releases.py`.
"Measured" means that they were looked up on another computer, on a day that was not recorded.
"Tried" means that the first drive was run on the release, on x86-64, with `tests/fresh/run`.
On arm64, set-up, page and a drive were tried by emulation, without ROS; the others are expected to work.
The Debian 13 root and the Python packages were tried on {_STAND_IN}.
"""
_ROS = {"native": "its own packages", "brought": "a Debian 13 root", "refused": "none: refused"}


def make_page(rows: Sequence[Release] | None = None) -> str:
    """The whole page."""
    rows = load_releases() if rows is None else rows
    columns = ("system", "ROS 1 from", "robots", "not packaged", "lists", "tried", "note")
    lines = [f"| {' | '.join(columns)} |", "|---" * len(columns) + "|"]
    for row in rows:
        missing = ", ".join("all of ROS 1" if name == "all" else name for name in row.missing)
        robots, tried = ("yes" if row.ros == "native" else "no"), ("yes" if row.tried else "")
        lines.append(f"| {row.name} | {_ROS[row.ros]} | {robots} | {missing} | {row.lists} | {tried} | {row.note} |")
    return _HEAD + "\n".join(lines) + "\n" + _FOOT


def make_table(rows: Sequence[Release] | None = None) -> str:
    """The table of the README: which ROS the releases that have a name run on, and whether that was tried."""
    rows = [row for row in (load_releases() if rows is None else rows) if not row.name.startswith(("other ", "any "))]
    native = [row for row in rows if row.ros == "native"]
    brought = _join([row.name for row in rows if row.ros == "brought"])
    wheels, root = "[as Python packages](docs/how-to/ros2.md)", "[a Debian 13 root](docs/explain/debian-root.md)"
    lines = [
        "| your computer | runs on | |",
        "|---|---|---|",
        f"| {_join([row.name for row in native if row.tried])} | the ROS 1 that they package | tried |",
        f"| {_join([row.name for row in native if not row.tried])} | the ROS 1 that they package | expected to work |",
        f"| {brought} | your own ROS 2 from Jazzy on, or ROS 2 {wheels} | expected to work |",
        f"| the same, on arm64 | your own ROS 2, none, or ROS 1 in {root} | none: tried by emulation |",
    ]
    return "\n".join([*lines, "", "[All releases](docs/reference/releases.md)"])


def replace_table(text: str, table: str) -> str:
    """A text with the table between its two marks. Raises ValueError where it lacks them."""
    pattern = rf"(?s)(?<={re.escape(BEGIN)}\n).*?(?=\n{re.escape(END)})"
    replaced, count = re.subn(pattern, lambda _: table, text)
    if count != 1:
        raise ValueError(f"expected the marks {BEGIN} and {END} once")
    return replaced


def _join(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def main() -> None:
    """Write the page and the table."""
    PAGE.write_text(make_page(), encoding="utf-8")
    README.write_text(replace_table(README.read_text(encoding="utf-8"), make_table()), encoding="utf-8")
    print(PAGE, README, sep="\n")


if __name__ == "__main__":
    main()
