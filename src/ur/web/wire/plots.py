"""Plots that a page shows: numeric fields of topics, as the page names them when it connects."""

import re

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
