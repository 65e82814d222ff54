"""Classes and definitions of messages that are installed; see also `ur_nodes.message_packages`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, cast

from ur_nodes.codecs.bare import BareGridUpdate, BareTransforms

if TYPE_CHECKING:
    import genpy

_BARE: Mapping[tuple[str, str], type[BareGridUpdate | BareTransforms]] = {
    each.BARE[:2]: each for each in (BareGridUpdate, BareTransforms)
}
_DEEPEST = 20  # types within types
_SEPARATOR = "\n" + "=" * 80 + "\n"


def find_class(type_name: str, part: str = "msg") -> type[genpy.Message] | None:
    """Find the class of a type, 'package/Name' or 'package/msg/Name'; None if it is not installed.

    `part` is 'srv' for a service.
    """
    package, name = split_type(type_name)
    if not package or _definition_file(package, name, part) is None:
        return None  # nothing is imported that a name from the network invents
    try:
        return cast("type[genpy.Message] | None", getattr(import_module(f"{package}.{part}"), name, None))
    except Exception:  # a package of a workspace raises anything
        return None


def find_schema(type_name: str) -> str | None:
    """Return the definition of a type and of its fields' types; None if it is not installed."""
    package, name = split_type(type_name)
    text = _read_definition(package, name)
    if text is None:
        return None
    parts, known, waiting = [text], set[str](), list(_types_in(text, package))
    while waiting and len(known) < _DEEPEST:
        each = waiting.pop(0)
        inner = _read_definition(*split_type(each))
        if each in known or inner is None:
            continue
        known.add(each)
        parts.append(f"MSG: {each}\n{inner}")
        waiting += _types_in(inner, split_type(each)[0])
    return _SEPARATOR.join(parts)


def find_bare(type_name: str) -> type[genpy.Message] | None:
    """Find the class of a type whose messages this project writes and reads as bytes; None for any other."""
    return cast("type[genpy.Message] | None", _BARE.get(split_type(type_name)))


def split_type(type_name: str) -> tuple[str, str]:
    """Split the name of a type into package and name; both are empty if it is no name of a type."""
    parts = type_name.split("/")
    if len(parts) not in (2, 3) or not all(each.isidentifier() for each in parts):
        return "", ""
    return parts[0], parts[-1]


def _read_definition(package: str, name: str) -> str | None:
    file = _definition_file(package, name)
    if file is not None:
        return file.read_text(encoding="utf-8")
    bare = _BARE.get((package, name))
    return None if bare is None else bare.DEFINITION


def _definition_file(package: str, name: str, part: str = "msg") -> Path | None:
    if not package:
        return None
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        file = Path(prefix, "share", package, part, f"{name}.{part}")
        if prefix and file.is_file():
            return file
    return None


def _types_in(text: str, package: str) -> Iterable[str]:
    """Return the types of the fields of a definition that are messages themselves."""
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        if not words or not words[0][:1].isalpha():
            continue
        kind = words[0].partition("[")[0].partition("<")[0]
        if "/" in kind:
            yield kind
        elif kind[0].isupper():
            yield f"{package}/{kind}"
