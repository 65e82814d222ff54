"""Requests of pages that view: in the address of the web socket, and in messages when the view changes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from msgspec import Meta

from ur.source.foreign.json_values import read_json
from ur.web.wire.frames import Layer
from ur.web.wire.layers import read_layers
from ur.web.wire.plots import read_plots

LONGEST = 4096
"""Characters of a message: eight plots with the longest names fit in."""

_Texts = Annotated[
    dict[Literal["layers", "plots"], str], Meta(min_length=1, description="an object with layers and plots, texts")
]


@dataclass(frozen=True, slots=True)
class ViewRequest:
    """The layers that a page shows, with `Layer.PLOTS` while its plots are open, and the plots."""

    layers: frozenset[Layer]
    plots: frozenset[str] = frozenset()


def read_view(values: Mapping[str, str]) -> ViewRequest:
    """Decode the `layers` and `plots` of a query. Raises BadRequestError."""
    layers, plots = read_layers(values.get("layers")), read_plots(values.get("plots"))
    return ViewRequest(layers) if plots is None else ViewRequest(layers | {Layer.PLOTS}, plots)


def read_view_message(data: object) -> ViewRequest:
    """Decode a message: a JSON object with the same texts as the query. Raises BadRequestError."""
    return read_view(read_json(data if isinstance(data, str) else None, _Texts, LONGEST))
