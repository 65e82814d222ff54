"""Requests of pages that look: in the address of the web socket, and in messages when what they show changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ur.web.wire.frames import Layer
from ur.web.wire.layers import read_layers
from ur.web.wire.plots import read_plots
from ur.web.wire.reading import BadRequestError, read_object

LONGEST = 4096
"""Characters of a message: eight plots with the longest names fit in."""

_KEYS = frozenset({"layers", "plots"})


@dataclass(frozen=True, slots=True)
class ViewRequest:
    """The layers that a page shows, `Layer.PLOTS` among them while its plots are open, and the plots."""

    layers: frozenset[Layer]
    plots: frozenset[str] = frozenset()


def read_view(values: Mapping[str, str]) -> ViewRequest:
    """The request that `layers` and `plots` of a query make. Raises BadRequestError."""
    layers, plots = read_layers(values.get("layers")), read_plots(values.get("plots"))
    return ViewRequest(layers) if plots is None else ViewRequest(layers | {Layer.PLOTS}, plots)


def read_view_message(data: object) -> ViewRequest:
    """The request of a message: a JSON object of the same texts. Raises BadRequestError."""
    value = read_object(data, LONGEST)
    if not value or not _KEYS.issuperset(value):
        raise BadRequestError(f"expected an object with {' and '.join(sorted(_KEYS))}")
    if not all(isinstance(each, str) for each in value.values()):
        raise BadRequestError("expected texts")
    return read_view(value)
