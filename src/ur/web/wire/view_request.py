"""The view of a page, as it reports it when it connects and when it changes: layers, and plots of fields of topics."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from msgspec import Meta

from ur.source.foreign.json_values import read_json
from ur.web.wire.frames import Layer
from ur.web.wire.layers import read_layers
from ur.web.wire.reading import BadRequestError

MOST_PLOTS = 8
"""Plots of one page."""

PLOT = re.compile(r"/[A-Za-z0-9_/]{1,100}:[A-Za-z0-9_]{1,40}(\.[A-Za-z0-9_]{1,40}){0,6}", re.ASCII)
"""A topic's full name and the path of a field."""


def read_plots(text: str | None) -> frozenset[str] | None:
    """Decode a list of plots separated by commas; None without a list. Raises BadRequestError."""
    if text is None:
        return None
    plots = text.split(",") if text else []
    if len(plots) > MOST_PLOTS or not all(PLOT.fullmatch(plot) for plot in plots):
        raise BadRequestError(f"plots: expected at most {MOST_PLOTS} of the form /TOPIC:FIELD, separated by commas")
    return frozenset(plots)


def split_plot(plot: str) -> tuple[str, str]:
    """Split a plot into its topic and the path of its field."""
    topic, _, path = plot.partition(":")
    return topic, path


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
