"""`ur doctor --wireless`: signal, latency and loss between this computer and a robot, once or continuously."""

import os
import shutil
import socket
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from datetime import datetime
from pathlib import Path
from typing import TextIO

import click

from ur.cli.output import plain_text
from ur.request.remote.connection import robot_address
from ur.robot.discovery.seen import load_seen, seen_path
from ur.robot.doctor.wifi import WirelessLink
from ur.robot.ssh.address import Address
from ur.robot.wireless.meter import Meter
from ur.robot.wireless.sample import HEADER, Sample, advise, summarize, write_row
from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.source.progress_line import show_progress
from ur.source.replace import check_output

Names = tuple[str, str]
TICK = 1.0  # s
KEPT = 3600  # samples
SETTLE = 2  # s in which no echo can be settled yet


def measure_wireless(robot: str | None, watch: bool, seconds: int | None, log: Path | None) -> int:
    """Measure and print signal, latency and loss; return 1 without any answer."""
    address = robot_address(robot)
    if shutil.which("ping") is None:
        try:
            resolve(address)
        except OSError:
            raise _unknown(address) from None
        raise user_error("ping is not installed", rule="no-ping", help="sudo apt-get install iputils-ping")
    names = socket.gethostname().split(".")[0], address.host.removesuffix(".local")
    samples: list[Sample] = []
    with ExitStack() as stack:
        file = stack.enter_context(_open_log(log)) if log else None
        try:
            meter = stack.enter_context(Meter(address.user, address.host, lambda: resolve(address)))
        except OSError:
            raise _unknown(address) from None
        ticks = _measure(meter, samples, file, None if watch and seconds is None else seconds or 5)
        try:
            if not watch:
                count = seconds or 5
                with show_progress(f"measuring for {count} s") as progress:
                    for _ in ticks:
                        progress(f"measuring: {len(samples)} of {count} samples")
            else:
                for sample in ticks:
                    click.echo(f"{describe_sample(sample, names)}  {advise(samples, names)}")
        except KeyboardInterrupt:
            pass  # Ctrl-C ends it
    _print_summary(samples, names, meter, log)
    return 0 if any(not sample.gap for sample in samples) else 1


def _measure(
    meter: Meter,
    samples: list[Sample],
    file: TextIO | None,
    seconds: int | None,
    clock: Callable[[], float] = time.monotonic,
) -> Iterator[Sample]:
    """Yield a sample each second, which is also appended to `samples` and written to `file`."""
    due = clock() + SETTLE
    while seconds is None or len(samples) < seconds:
        time.sleep(max(0.0, due - clock()))
        due += TICK
        sample = meter.sample()
        samples.append(sample)
        del samples[:-KEPT]
        if file:
            write_row(file, sample, samples[0].time)
        yield sample


def resolve(address: Address) -> str:
    """Return the robot's IPv4 address: by its name, else the last known one. Raises OSError."""
    try:
        found = socket.getaddrinfo(address.host, None, socket.AF_INET, socket.SOCK_STREAM)
        return str(found[0][4][0])
    except OSError:
        seen = load_seen(seen_path(os.environ)).get(address.host.removesuffix(".local"))
        if seen is None:
            raise
        return seen.address


def _open_log(path: Path) -> TextIO:
    check_output(path)
    try:
        file = path.open("x", encoding="utf-8")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error_about(path, f"cannot be written: {reason}", rule="bad-log") from None
    file.write(HEADER)
    return file


def _unknown(address: Address) -> UserError:
    help = f"is it on, and in the same network? ur doctor {address.host} goes the way step by step"
    return user_error_about(address.host, "no computer answers to this name", rule="unknown-host", help=help)


def describe_sample(sample: Sample, names: Names) -> str:
    """Describe a second in one line."""
    latency = "no answer" if sample.latency is None else f"{sample.latency * 1000:.1f} ms"
    links = [f"{name} {_link(link)}" for name, link in zip(names, (sample.here, sample.there), strict=True) if link]
    parts = [f"latency {latency}", f"loss {sample.loss:.0%}", *links]
    return f"{_clock(sample.time)}  " + "  ".join(parts)


def _meter_note(meter: Meter, names: Names) -> str:
    """Return a note about signals that cannot be shown, with the reason; '' if all can."""
    radios = list(zip(names, (meter.here, meter.there), strict=True))
    without = [name for name, radio in radios if radio.wireless is False]
    silent = [name for name, radio in radios if radio.wireless is None]
    parts = [f"no wireless interface at {' and '.join(without)}"] if without else []
    parts += [f"no login to {name} by key, so nothing is known of its signal" for name in silent]
    return "; ".join(parts) + (": latency and loss only" if len(without) == len(radios) else "")


def _print_summary(samples: Sequence[Sample], names: Names, meter: Meter, log: Path | None) -> None:
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
    latest = samples[-1]
    rows = [
        (f"signal at {name}", _link(link) if link else "", f"{signals[1]:.0f} dBm", f"{signals[0]:.0f} dBm")
        for name, link, signals in zip(names, (latest.here, latest.there), (whole.here, whole.there), strict=True)
        if signals
    ]
    now = "no answer" if latest.latency is None else f"{latest.latency * 1000:.1f} ms"
    middle, worst = (f"{value * 1000:.1f} ms" for value in whole.latency[1:]) if whole.latency else ("", "")
    away = {0: "", 1: "away once"}.get(whole.gaps, f"away {whole.gaps} times")
    for row in [*rows, ("latency", now, middle, worst), ("loss", f"{latest.loss:.0%}", f"{whole.loss:.1%}", away)]:
        table.add_row(*map(plain_text, row))
    Console(soft_wrap=not sys.stdout.isatty()).print(table)
    for line in (_meter_note(meter, names), advise(samples, names), f"written to {log}" if log else ""):
        if line:
            click.echo(line)


def _link(link: WirelessLink) -> str:
    parts = [
        "" if link.signal is None else f"{link.signal:.0f} dBm",
        "" if link.rate is None else f"{link.rate:g} Mbit/s",
        link.band,
    ]
    return ", ".join(part for part in parts if part) or link.device


def _clock(moment: float) -> str:
    return datetime.fromtimestamp(moment).astimezone().strftime("%H:%M:%S")
