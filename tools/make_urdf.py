"""Write n_robot_state_publisher/urdf/<base>[.<variant>].urdf for every base: make_urdf.py [PACKAGE]."""

from __future__ import annotations

import sys
from pathlib import Path

from ur.robot.base import list_bases, list_variants, load_base
from ur.robot.urdf import write_urdf


def make_urdfs(package: Path) -> dict[str, str]:
    """File name to text, for every base and variant of a launch package."""
    found = {}
    for name in list_bases(package):
        for variant in ("", *list_variants(package, name)):
            found[f"{name}.{variant}.urdf" if variant else f"{name}.urdf"] = write_urdf(
                load_base(package, name, variant)
            )
    return found


def main() -> None:
    """Write the files."""
    package = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "ubiquity_launches"
    folder = package / "n_robot_state_publisher" / "urdf"
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in make_urdfs(package).items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
