"""Names that parameters of programs hold: of the map in use, and of the service that saves one that is being made."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ur.maps.names import is_map_name

_SERVICE = re.compile(r"/?[A-Za-z][\w/]{0,200}", re.ASCII)


def choose_service(values: Sequence[object]) -> str:
    """The first of these values of parameters that is the name of a service; "": none is."""
    names = (each for each in values if isinstance(each, str) and _SERVICE.fullmatch(each))
    return next(names, "")


def choose_name(value: object, *, made: bool) -> str:
    """The name of the stored map that a program navigates on; "" for a file, and for a map that is being `made`."""
    return value if isinstance(value, str) and is_map_name(value) and not made else ""
