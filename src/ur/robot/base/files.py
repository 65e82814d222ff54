"""Base files of launch packages and workspaces, and their variants."""

from collections.abc import Mapping
from pathlib import Path

from ur.robot.base.properties import Base
from ur.robot.base.reader import read_whole
from ur.source.diagnostic import UserError, error
from ur.source.section import Section, read_section
from ur.source.suggest import did_you_mean
from ur.source.user_folders import MARKER, list_workspaces


def is_base_name(name: str) -> bool:
    """Return whether a text is a valid base name: a single folder name, not a path."""
    return bool(name) and "/" not in name and "\0" not in name and name not in (".", "..")


def list_base_packages(package: Path, environment: Mapping[str, str]) -> tuple[Path, ...]:
    """Return the folders whose `bases/` belong to a launch package: its own, then those of workspaces, in order."""
    prefixes = map(Path, list_workspaces(environment))
    added = [prefix / "share" / package.name for prefix in prefixes if (prefix / MARKER).is_file()]
    return (package, *(folder for folder in added if (folder / "bases").is_dir()))


def find_base_package(package: Path, name: str, environment: Mapping[str, str]) -> Path:
    """Return the first of these folders that contains the base; the launch package if none does."""
    found = (
        folder
        for folder in list_base_packages(package, environment)
        if is_base_name(name) and (folder / "bases" / name / "base.yaml").is_file()
    )
    return next(found, package)


def list_bases(package: str | Path) -> tuple[str, ...]:
    """Return the sorted names of the bases in a launch package, from its files `bases/*/base.yaml`."""
    return tuple(sorted(path.parent.name for path in (Path(package) / "bases").glob("*/base.yaml")))


def load_base(package: str | Path, name: str, variant: str = "") -> Base:
    """Read a base of a launch package. Raises UserError for an unknown base or variant, or an invalid file."""
    path = Path(package) / "bases" / name / "base.yaml"
    if not is_base_name(name) or not path.is_file():
        names = list_bases(package)
        near = did_you_mean(name, names)
        raise UserError(
            error(
                f"unknown base {name!r}, expected one of {', '.join(names) or '(no base found)'}",
                rule="unknown-base",
                help=f"did you mean {near!r}?" if near else _how_to_make(name),
                subject=name,
            )
        )
    return read_base(path, name, variant)


def _how_to_make(name: str) -> str:
    shown = name if name.isascii() and name.isidentifier() else "NAME"
    return f"make it from the robot's URDF: ur new base {shown} --from FILE --workspace FOLDER"


def read_base(path: str | Path, name: str, variant: str = "") -> Base:
    """Read one base file in one variant, whose values override those of the plain base."""
    return read_base_section(read_section(path, "a base file"), name, variant)


def read_base_section(whole: Section, name: str, variant: str = "") -> Base:
    """Read a base from a file that is already parsed into the section `whole`, as `read_base` does."""
    plain = whole.without("variants")
    variants = dict(whole.section("variants").subsections()) if whole.has("variants") else {}
    for overlay in variants.values():
        # An invalid variant makes the file invalid, whichever variant is requested
        read_whole(plain.merged(overlay), name, "")
    if variant and variant not in variants:
        near = did_you_mean(variant, variants)
        expected = f"expected one of {', '.join(variants)}" if variants else "this base has no variants"
        raise UserError(
            error(
                f"variant {variant!r} of base {name!r} is not known, {expected}",
                rule="unknown-variant",
                help=f"did you mean {near!r}?" if near else "leave the variant out for the plain base",
                subject=variant,
            )
        )
    return read_whole(plain.merged(variants[variant]) if variant else plain, name, variant)


def list_variants(package: str | Path, name: str) -> tuple[str, ...]:
    """Return the names of a base's variants in the order of its file; the plain base is not among them."""
    whole = read_section(Path(package) / "bases" / name / "base.yaml", "a base file")
    return whole.section("variants").keys if whole.has("variants") else ()
