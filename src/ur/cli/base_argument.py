"""Is the robot base that a launch file is given one that there is, and has it what the file needs?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ur.launchfile.syntax.parse import parse_launch_file
from ur.launchfile.world.protocol import World
from ur.robot.base import Base, list_variants, load_base
from ur.source.diagnostic import UserError, error

NEEDS = "Needs:"


def check_base(files: Sequence[str], values: Mapping[str, str], world: World) -> None:
    """Compare `robot_base` and `robot_variant` with the bases of the package that a launch file belongs to.

    A comment `<!--Needs: SENSOR ...-->` directly in `<launch>` names what the base must have. Packages without a folder
    `bases` are left alone. Raises UserError: no such base or variant, a bad base file, a sensor that the base lacks.
    """
    name = values.get("robot_base")
    if name is None:
        return
    for path in files:
        package = _find_package(path)
        if package is None:
            continue
        base = load_base(package, name, values.get("robot_variant", ""))
        for sensor in _needs(path, world):
            if sensor not in _sensors(base):
                raise _lack(path, package, base, sensor)


def _find_package(path: str) -> Path | None:
    for folder in Path(path).resolve().parents:
        if (folder / "package.xml").is_file():
            return folder if (folder / "bases").is_dir() else None
    return None


def _needs(path: str, world: World) -> Iterator[str]:
    try:
        launch = parse_launch_file(path, world.read_bytes(path)).launch
    except OSError:
        return
    for comment in launch.comments if launch is not None else ():
        if comment.text.startswith(NEEDS):
            yield from comment.text.removeprefix(NEEDS).replace(",", " ").split()


def _sensors(base: Base) -> tuple[str, ...]:
    return tuple(name for name in ("lidar", "raspicam") if getattr(base, name))


def _lack(path: str, package: Path, base: Base, sensor: str) -> UserError:
    whole = f"{base.name!r}, variant {base.variant!r}," if base.variant else f"{base.name!r}"
    variants = [
        each for each in list_variants(package, base.name) if sensor in _sensors(load_base(package, base.name, each))
    ]
    return UserError(
        error(
            f"{Path(path).name} needs a {sensor}, and base {whole} has none",
            rule="base-lacks",
            help=f"its variant {variants[0]!r} has one: robot_variant:={variants[0]}"
            if variants
            else "choose another base",
        )
    )
