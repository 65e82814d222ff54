"""Measured seconds as comma-separated values (RFC 4180). Pure but for the file."""

from datetime import datetime, timezone
from typing import TextIO

from ur.robot.doctor.wifi import WirelessLink
from ur.robot.wireless.sample import Sample

_LINK = ("device", "signal_dbm", "rate_mbit_s", "frequency_mhz")
COLUMNS = (
    *("time", "seconds", "sent", "lost", "latency_ms"),
    *(f"here_{name}" for name in _LINK),
    *(f"robot_{name}" for name in _LINK),
)
HEADER = ",".join(COLUMNS) + "\n"


def render_row(sample: Sample, start: float) -> str:
    """Format a second as a line. `start` (s since 1970) is its beginning; unknown values are left empty."""
    moment = datetime.fromtimestamp(sample.time, timezone.utc).isoformat(timespec="milliseconds")
    latency = "" if sample.latency is None else f"{sample.latency * 1000:.3f}"
    first = (moment, f"{sample.time - start:.1f}", str(sample.sent), str(sample.lost), latency)
    return ",".join((*first, *_link(sample.here), *_link(sample.there))) + "\n"


def write_row(file: TextIO, sample: Sample, start: float) -> None:
    """Write a second and flush it, so that a crash cannot lose it."""
    file.write(render_row(sample, start))
    file.flush()


def _link(link: WirelessLink | None) -> tuple[str, ...]:
    if link is None:
        return "", "", "", ""
    return link.device, *("" if value is None else f"{value:g}" for value in (link.signal, link.rate, link.frequency))
