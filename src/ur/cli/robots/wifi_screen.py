"""The output of `ur wifi`: live plots, lines, and a table at the end."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.cli.output import plain_text
from ur.robot.doctor.wifi import WirelessLink
from ur.robot.wireless.advice import advise
from ur.robot.wireless.meter import Meter
from ur.robot.wireless.plot import log_scale, plot, plot_bars
from ur.robot.wireless.sample import Sample, Summary, summarize

if TYPE_CHECKING:
    from rich.text import Text

Names = tuple[str, str]
SIGNALS = (-90.0, -30.0)  # dBm
LATENCIES = (-4.0, 0.0)  # decades of s: 0.1 ms to 1 s
EDGE = 9  # characters for the scale
TALL = 24  # lines of a terminal from which plots get more than three lines


def describe_sample(sample: Sample, names: Names) -> str:
    """Describe a second in one line."""
    latency = "no answer" if sample.latency is None else f"{sample.latency * 1000:.1f} ms"
    links = [f"{name} {_link(link)}" for name, link in zip(names, (sample.here, sample.there), strict=True) if link]
    parts = [f"latency {latency}", f"loss {sample.loss:.0%}", *links]
    return f"{_clock(sample.time)}  " + "  ".join(parts)


def draw_screen(ticks: Iterable[Sample], samples: Sequence[Sample], names: Names, meter: Meter) -> None:
    """Draw plots over the whole terminal, updated with each tick."""
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    console = Console()
    with Live(Text("measuring ..."), console=console, screen=True, auto_refresh=False) as live:
        for _ in ticks:
            live.update(
                render_screen(samples, names, meter_note(meter, names), console.width, console.height), refresh=True
            )


def render_screen(samples: Sequence[Sample], names: Names, note: str, width: int, height: int) -> Text:
    """Return the whole screen as a text of at most `width` by `height` characters."""
    from rich.text import Text

    wide = max(10, width - EDGE - 1)
    radios = [
        (name, [_signal(getattr(sample, side)) for sample in samples])
        for name, side in zip(names, ("here", "there"), strict=True)
    ]
    radios = [(name, signals) for name, signals in radios if any(signal is not None for signal in signals)]
    tall = max(1, min(8, (height - 6 - len(radios)) // (len(radios) + 1) - 1))
    latest = samples[-1]
    text = Text(no_wrap=True, overflow="crop")
    text.append(f"{names[0]} - {names[1]}", "bold")
    text.append(f"   {_clock(latest.time)}   {len(samples)} s   Ctrl-C ends it\n", "dim")
    for (name, signals), colour in zip(radios, ("cyan", "magenta"), strict=False):
        link = latest.here if name == names[0] else latest.there
        _section(text, f"signal at {name}", _link(link) if link else "no signal", colour)
        _plot(text, plot(signals, *SIGNALS, wide, tall), ["-30 dBm", "-60 dBm", "-90 dBm"], colour)
    now = "no answer" if latest.latency is None else f"{latest.latency * 1000:.1f} ms"
    _section(text, "latency", now, "red" if latest.gap else "green")
    _plot(
        text,
        plot(log_scale([sample.latency for sample in samples]), *LATENCIES, wide, tall),
        ["1 s", "10 ms", "0.1 ms"],
        "green",
    )
    _section(text, "loss", f"{latest.loss:.0%}", "red" if latest.lost else "green")
    _plot(text, [plot_bars([sample.loss for sample in samples], wide)], ["100 %"], "red")
    if note:
        text.append(f"{note}\n", "dim")
    text.append(advise(samples, names)[: width - 1], "bold yellow")
    return text


def meter_note(meter: Meter, names: Names) -> str:
    """Return a note about signals that cannot be shown, with the reason; '' if all can."""
    radios = list(zip(names, (meter.here, meter.there), strict=True))
    without = [name for name, radio in radios if radio.wireless is False]
    silent = [name for name, radio in radios if radio.wireless is None]
    parts = [f"no wireless interface at {' and '.join(without)}"] if without else []
    parts += [f"no login to {name} by key, so nothing is known of its signal" for name in silent]
    return "; ".join(parts) + (": latency and loss only" if len(without) == len(radios) else "")


def print_summary(samples: Sequence[Sample], names: Names, meter: Meter, log: Path | None) -> None:
    """Print a table of all measurements, with the advice."""
    from rich.console import Console
    from rich.table import Table

    if not samples:
        click.echo("nothing was measured")
        return
    whole = summarize(samples)
    table = Table(title=plain_text(f"{names[0]} - {names[1]}, {whole.seconds} s"), title_justify="left")
    for column in ("", "now", "median", "worst"):
        table.add_column(column)
    for row in _rows(samples[-1], whole, names):
        table.add_row(*map(plain_text, row))
    Console(soft_wrap=not sys.stdout.isatty()).print(table)
    for line in (meter_note(meter, names), advise(samples, names), f"written to {log}" if log else ""):
        if line:
            click.echo(line)


def _rows(latest: Sample, whole: Summary, names: Names) -> list[tuple[str, str, str, str]]:
    rows = [
        (f"signal at {name}", _link(link) if link else "", f"{signals[1]:.0f} dBm", f"{signals[0]:.0f} dBm")
        for name, link, signals in zip(names, (latest.here, latest.there), (whole.here, whole.there), strict=True)
        if signals
    ]
    now = "no answer" if latest.latency is None else f"{latest.latency * 1000:.1f} ms"
    middle, worst = (f"{value * 1000:.1f} ms" for value in whole.latency[1:]) if whole.latency else ("", "")
    away = {0: "", 1: "away once"}.get(whole.gaps, f"away {whole.gaps} times")
    return [*rows, ("latency", now, middle, worst), ("loss", f"{latest.loss:.0%}", f"{whole.loss:.1%}", away)]


def _section(text: Text, title: str, now: str, colour: str) -> None:
    text.append(f"{title}  ")
    text.append(f"{now}\n", f"bold {colour}")


def _plot(text: Text, lines: Sequence[str], scale: Sequence[str], colour: str) -> None:
    for index, line in enumerate(lines):
        label = {0: scale[0], len(lines) // 2: scale[len(scale) // 2]}.get(index, "")
        label = scale[-1] if index and index == len(lines) - 1 else label
        text.append(f"{label:>{EDGE - 1}} ", "dim")
        for sign in line:
            text.append(sign, "bold red" if sign == "×" else colour)  # noqa: RUF001 - the sign of a gap
        text.append("\n")


def _link(link: WirelessLink) -> str:
    parts = [
        "" if link.signal is None else f"{link.signal:.0f} dBm",
        "" if link.rate is None else f"{link.rate:g} Mbit/s",
        link.band,
    ]
    return ", ".join(part for part in parts if part) or link.device


def _signal(link: WirelessLink | None) -> float | None:
    return link.signal if link else None


def _clock(moment: float) -> str:
    return datetime.fromtimestamp(moment).astimezone().strftime("%H:%M:%S")
