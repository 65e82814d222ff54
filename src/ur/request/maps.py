"""The argument `map` of programs that navigate: the name of a stored map, checked before anything starts."""

from __future__ import annotations

import os
from collections.abc import Collection, Sequence

from ur.maps.names import LATEST, check_map_name
from ur.maps.store import own_store
from ur.request.arguments import Argument, values_of

_MAP = "map"
_OTHERS = ("map_file", "world")


def resolve_map(
    arguments: Sequence[Argument], declared: Collection[str], *, real: bool, remote: bool
) -> tuple[Argument, ...]:
    """Check the map that a launch file with the arguments `map` and `map_file` is to use.

    Without one, a real robot uses the last map that it has made. `remote`: the map is on another computer. Raises
    UserError: this computer has no such map.
    """
    if _MAP not in declared or "map_file" not in declared:
        return tuple(arguments)
    values = values_of(arguments)
    store = own_store(os.environ)
    if name := values.get(_MAP, ""):
        if "map_file" in values:
            return tuple(arguments)
        resolved = (name if name == LATEST else check_map_name(name)) if remote else store.resolve(name)
        return tuple(Argument(_MAP, resolved) if each.name == _MAP else each for each in arguments)
    if not real or _MAP in values or any(other in values for other in _OTHERS) or values.get("simulate") == "true":
        return tuple(arguments)
    if values.get("localisation") == "fiducials":
        return tuple(arguments)
    found = LATEST if remote else store.latest()
    return (*arguments, Argument(_MAP, found)) if found else tuple(arguments)
