"""Is the robot base that a launch file is given one that there is, and has it what the file needs?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ur.launchfile.world.protocol import World
from ur.request.needs import Need, describe_need, find_variants, list_lacks, read_needs
from ur.robot.base import Base, list_bases, load_base
from ur.robot.base.search import find_base_package
from ur.source.diagnostic import UserError, error


def check_base(files: Sequence[str], values: Mapping[str, str], world: World) -> None:
    """Compare `robot_base` and `robot_variant` with the bases of the package that a launch file belongs to.

    The comment `<!--Needs: ...-->` names what the base must have (`ur.request.needs`). Packages without folder `bases`
    are skipped; bases that workspaces add are found, too. Raises UserError: no such base or variant, a bad base
    file, something that the base lacks.
    """
    name = values.get("robot_base")
    if name is None:
        return
    for path in files:
        own = find_package(path)
        if own is None:
            continue
        package = find_base_package(own, name, world.environment)
        base = load_base(package, name, values.get("robot_variant", ""))
        needs = read_needs(path, world)
        lacks = list_lacks(base, needs)
        if lacks:
            raise _lack(path, package, base, needs, lacks)


def find_package(path: str) -> Path | None:
    """The folder of the package that a launch file belongs to, if it has bases."""
    for folder in Path(path).resolve().parents:
        if (folder / "package.xml").is_file():
            return folder if (folder / "bases").is_dir() else None
    return None


def _lack(path: str, package: Path, base: Base, needs: Sequence[Need], lacks: Sequence[Need]) -> UserError:
    whole = f"{base.name!r}, variant {base.variant!r}," if base.variant else f"{base.name!r}"
    wanted = " and ".join(describe_need(need) for need in lacks)
    variants = find_variants(package, base, needs)
    if not variants:
        able = [name for name in list_bases(package) if not list_lacks(load_base(package, name), needs)]
        help_ = f"choose another base: robot_base:={able[0]}" if able else "choose another base"
        help_ += f", or {', '.join(able[1:])}" if able[1:] else ""
    elif variants[0]:
        help_ = f"its variant {variants[0]!r} has what is needed: robot_variant:={variants[0]}"
    else:
        help_ = "the plain base, without a variant, has what is needed"
    message = f"{Path(path).name} needs {wanted}, and base {whole} has none"
    return UserError(error(message, rule="base-lacks", help=help_))
