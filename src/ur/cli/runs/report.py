"""`ur report`: what happened in a run, as one archive."""

import os
import time
from pathlib import Path

import click

from ur.cli.runs.detached import choose_run
from ur.cli.runs.logs import find_ended_run
from ur.run.record.registry import EndedRun
from ur.source.diagnostic import UserError

_AFTER_END = 120.0  # s after a run in which its black box may still write
_WITHIN = 10.0  # s for the black box to write
_LOOK = 0.1  # s


@click.command("report")
@click.argument("run", required=False)
@click.option("-o", "--output", metavar="FILE", help="The archive; report_RUN.zip here unless given.")
def command(run: str | None, output: str | None) -> int:
    """Write what happened in a run into one archive.

    The archive has the newest recording of the black box, logs, parameters and versions. If the run is active, its
    black box writes its recording first.
    Passwords, keys, tokens, names of wireless networks and of home folders are removed; removed.txt lists where.
    """
    from ur.recordings.black_boxes import recordings_folder
    from ur.report.archive import ZIP, list_run_recordings, write_report
    from ur.report.sources import collect
    from ur.request.requirements.python_packages import need_all
    from ur.source.replace import check_output

    ended = find_ended_run(run)
    entry = choose_run(run) if ended is None else ended.entry
    path = Path(output or f"report_{entry.run}.zip").absolute()
    check_output(path, begin=ZIP)
    unreadable = ""
    try:
        need_all(["mcap", "rosbags"], "recordings.lock", "what recordings need (12 MB to download)")
    except UserError as problem:  # for instance without a network
        unreadable = str(problem)
    folder = Path(recordings_folder(os.environ))
    if ended is None:
        _await_recording(folder)
    sources = collect(entry, ended, os.environ)
    recordings = list_run_recordings(folder, entry.started, _end_of(ended))
    report = write_report(path, sources, recordings, unreadable)
    for each in report.missing:
        click.echo(f"warning: the report is without {each}", err=True)
    click.echo(f"{report.path}: {report.size / 1e6:.1f} MB")
    click.echo(f"removed secrets: {len(report.removed)}; removed.txt in it lists them", err=True)
    return 0


def _await_recording(folder: Path) -> None:
    """Have the black boxes that run write, and wait until one has."""
    from ur.recordings.black_boxes import REPORT_REQUEST, notify_black_boxes
    from ur.report.archive import list_run_recordings

    begin = time.time()
    if not notify_black_boxes(os.environ, REPORT_REQUEST):
        return
    until = time.monotonic() + _WITHIN
    while time.monotonic() < until and not list_run_recordings(folder, begin, begin + 3600.0):
        time.sleep(_LOOK)


def _end_of(ended: EndedRun | None) -> float:
    return time.time() + 1.0 if ended is None else ended.ended + _AFTER_END
