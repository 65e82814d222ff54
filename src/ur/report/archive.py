"""The archive of a report: one zip, complete or absent, without secrets."""

import json
import tempfile
import time
import zipfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from itertools import groupby
from pathlib import Path

from ur.recordings.place import RecordedMap
from ur.report.recording import Recording, copy_recording, thin
from ur.report.secrets import SecretFilter
from ur.report.sources import RunSources, write_values
from ur.source.diagnostic import UserError
from ur.source.replace import PRIVATE, output_file

_WIDTH, _HEIGHT = 900, 120
_OCCUPIED = 50
_MOST_LINES = 2000
_STYLE = """
:root { color-scheme: light dark; font: 15px/1.45 system-ui, sans-serif }
body { max-width: 960px; margin: 0 auto; padding: 1rem }
h1 { font-size: 1.5rem } h2 { font-size: 1.15rem; margin-top: 2rem }
svg { width: 100%; height: auto; background: #8881; border-radius: 6px }
table { border-collapse: collapse; width: 100% } td, th { text-align: left; padding: .15rem .5rem; vertical-align: top;
 border-bottom: 1px solid #8884; overflow-wrap: anywhere; min-width: 4.5rem }
pre { overflow: auto; max-height: 30rem; background: #8881; padding: .6rem; border-radius: 6px; font-size: 12px }
.error, .fatal { color: #d33 } .warning { color: #b70 } .event { fill: #d33 } .line { fill: none; stroke: #27c;
 stroke-width: 1.5; vector-effect: non-scaling-stroke } .plot { height: 100px } .ends { display: flex; margin: 0;
 justify-content: space-between }
 .walls { fill: currentColor } .track { fill: none; stroke: #d33; vector-effect: non-scaling-stroke;
 stroke-width: 2 } .wide { overflow-x: auto } small { opacity: .7 }
"""


def make_page(title: str, run: object, recording: Recording, files: dict[str, str], removed: Sequence[str]) -> str:
    """The page. Texts are free of secrets, and may hold anything else."""
    parts = [
        f"<h1>{escape(title)}</h1>",
        _facts(run),
        "<h2>Timeline</h2>",
        _timeline(recording),
        "<h2>Map and track</h2>",
        _map(recording),
        "<h2>Speed</h2>",
        _plot(recording.speeds, "m/s"),
        "<h2>Turning</h2>",
        _plot(recording.turns, "rad/s"),
        "<h2>Log</h2>",
        _log(recording),
        "<h2>Topics</h2>",
        _table(
            ("topic", "type", "messages", "bytes"),
            [(name, kind, str(count), str(size)) for name, (kind, count, size) in recording.topics.items()],
        ),
        "<h2>Files</h2>",
        *(
            f"<details><summary>{escape(name)}</summary><pre>{escape(text)}</pre></details>"
            for name, text in files.items()
        ),
        "<h2>Removed</h2>",
        f"<pre>{escape(chr(10).join(removed) or 'nothing')}</pre>",
    ]
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1"><link rel="icon" href="data:,">'
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>{''.join(parts)}</body></html>\n"
    )


def _facts(run: object) -> str:
    if not isinstance(run, dict):
        return ""
    rows = [(str(key), value if isinstance(value, str) else json.dumps(value)) for key, value in run.items()]
    return _table(("", ""), [(key, value) for key, value in rows if value not in ("", "[]")])


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    titles = "".join(f"<th>{escape(each)}</th>" for each in head) if any(head) else ""
    body = "".join("<tr>" + "".join(f"<td>{escape(each)}</td>" for each in row) + "</tr>" for row in rows)
    return f'<div class="wide"><table><tr>{titles}</tr>{body}</table></div>'


def _timeline(found: Recording) -> str:
    if found.end <= found.begin:
        return (
            "<p>There is no recording of this run. <small>The black box writes one when something happens.</small></p>"
        )
    scale = _WIDTH / (found.end - found.begin)
    marks = []
    for moment, level, _ in found.log:
        if level in ("warning", "error", "fatal"):
            x = (moment - found.begin) * scale
            marks.append(f'<rect class="{level}" fill="currentColor" x="{x:.1f}" y="15" width="3" height="30"/>')
    for moment, text in found.events:
        x = (moment - found.begin) * scale
        marks.append(f'<circle class="event" cx="{x:.1f}" cy="30" r="9"><title>{escape(text)}</title></circle>')
    events = [(f"{_clock(moment)} ({moment - found.end:+.1f} s)", text) for moment, text in found.events]
    ends = f'<p class="ends"><small>{_clock(found.begin)}</small><small>{_clock(found.end)}</small></p>'
    svg = f'<svg viewBox="0 0 {_WIDTH} 60">{"".join(marks)}</svg>'
    return f"{svg}{ends}{_table(('time', 'event'), events)}"


def _map(found: Recording) -> str:
    track = found.track or ([] if found.grid else found.odometry)
    if found.grid is None and not track:
        return "<p>There is neither a map nor a track.</p>"
    walls, box = _walls(found.grid) if found.grid else ("", None)
    if box is None:
        xs, ys = [x for x, _ in track], [y for _, y in track]
        box = (min(xs) - 1.0, min(ys) - 1.0, max(xs) - min(xs) + 2.0, max(ys) - min(ys) + 2.0)
    x, y, width, height = box
    points = " ".join(f"{px:.3f},{py:.3f}" for px, py in thin(track))
    end = f'<circle class="event" cx="{track[-1][0]:.3f}" cy="{track[-1][1]:.3f}" r="0.2"/>' if track else ""
    return (
        f'<svg viewBox="{x:.3f} {-y - height:.3f} {width:.3f} {height:.3f}"><g transform="scale(1,-1)">'
        f'<path class="walls" d="{walls}"/><polyline class="track" points="{points}"/>{end}</g></svg>'
        f"<p><small>{width:.1f} m by {height:.1f} m; the track is that of "
        f"{'localisation' if found.track else 'the odometry'}, and the dot its end.</small></p>"
    )


def _walls(grid: RecordedMap) -> tuple[str, tuple[float, float, float, float]]:
    size = grid.resolution
    left, bottom, _ = grid.origin
    parts = []
    for row in range(grid.height):
        column = 0
        line = grid.cells[row * grid.width : (row + 1) * grid.width]
        for occupied, cells in groupby(line, lambda cell: _OCCUPIED <= cell <= 100):
            count = len(list(cells))
            if occupied:
                x, y, width = left + column * size, bottom + row * size, count * size
                parts.append(f"M{x:.2f} {y:.2f}h{width:.2f}v{size:.2f}h{-width:.2f}z")
            column += count
    return "".join(parts), (left, bottom, grid.width * size, grid.height * size)


def _plot(values: Sequence[tuple[float, float]], unit: str) -> str:
    if len(values) < 2:
        return "<p>Nothing was recorded.</p>"
    begin, end = values[0][0], values[-1][0]
    low, high = min(0.0, *(value for _, value in values)), max(0.0, *(value for _, value in values))
    scale_x, scale_y = _WIDTH / ((end - begin) or 1.0), (_HEIGHT - 20) / ((high - low) or 1.0)
    points = " ".join(
        f"{(moment - begin) * scale_x:.1f},{_HEIGHT - 10 - (value - low) * scale_y:.1f}"
        for moment, value in thin(values)
    )
    return (
        f'<svg class="plot" viewBox="0 0 {_WIDTH} {_HEIGHT}" preserveAspectRatio="none">'
        f'<polyline class="line" points="{points}"/></svg>'
        f'<p class="ends"><small>{low:.2f} to {high:.2f} {unit}</small>'
        f"<small>{_clock(begin)} to {_clock(end)}</small></p>"
    )


def _log(found: Recording) -> str:
    lines = [f'<span class="{level}">{_clock(moment)} {escape(text)}</span>' for moment, level, text in found.log]
    return f"<pre>{chr(10).join(lines[-_MOST_LINES:]) or 'nothing'}</pre>"


def _clock(moment: float) -> str:
    return time.strftime("%H:%M:%S", time.localtime(moment)) + f".{int(moment % 1.0 * 10)}"


MOST_BYTES = 20_000_000
ZIP = b"PK"  # the beginning of an archive
_MOST_IN_PAGE = 100_000  # characters of a file that the page repeats


@dataclass(frozen=True, slots=True)
class Report:
    """A report that was written: its bytes, a line for each kind of removed secrets and file, and what is missing."""

    path: Path
    size: int
    removed: tuple[str, ...]
    missing: tuple[str, ...]


def write_report(
    path: Path, title: str, sources: RunSources, recordings: Sequence[Path], unreadable: str = ""
) -> Report:
    """Write the archive. `recordings` are files of the black box, newest last, of which the newest is taken.

    `unreadable` is the reason why recordings cannot be read on this computer, '' where they can.
    Raises UserError.
    """
    secrets = SecretFilter()
    for tree in sources.values.values():
        secrets.learn(tree)
        secrets.learn_text(write_values(tree))
    for name, text in sources.versions:
        secrets.learn_file(name, text)
    for text in sources.texts.values():
        secrets.learn_text(text)
    missing = []
    with tempfile.TemporaryDirectory(prefix=".ur_report_", dir=path.parent) as folder:
        copy = Path(folder, "recording.mcap")
        recording = Recording()
        if unreadable:
            missing.append(f"the recording: {unreadable}")
        elif recordings:
            try:
                recording = copy_recording(recordings[-1], copy, secrets)
            except (OSError, UserError) as problem:
                missing.append(f"the recording: {problem}")
                copy.unlink(missing_ok=True)
        else:
            missing.append("a recording: the black box has written none during the run")
        if copy.exists() and copy.stat().st_size > MOST_BYTES * 3 // 4:
            copy.unlink()
            missing.append("the recording: it is too large")
        files = {name: write_values(secrets.clean_values(tree, name)) for name, tree in sources.values.items() if tree}
        for name, text in sources.texts.items():
            clean = secrets.clean_changes if name.endswith(".diff") else secrets.clean
            files[name] = clean(text, name)
        run = secrets.clean_values(sources.values.get("run.json", {}), "report.html")
        removed = tuple(f"{file}: {count} times a {kind}" for (file, kind), count in sorted(secrets.removed.items()))
        shown = {name: text[-_MOST_IN_PAGE:] for name, text in files.items()}
        files["report.html"] = make_page(secrets.clean(title, "report.html"), run, recording, shown, removed)
        files["removed.txt"] = "\n".join([*removed, *(f"missing: {each}" for each in missing)]) + "\n"
        with (
            output_file(path, recordings, ZIP, mode=PRIVATE) as file,
            zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive,
        ):
            for name, text in files.items():
                archive.writestr(name, text)
            if copy.exists():
                archive.write(copy, "recording.mcap", zipfile.ZIP_STORED)
    return Report(path, path.stat().st_size, removed, tuple(missing))


def list_run_recordings(folder: Path, begin: float, end: float) -> list[Path]:
    """The recordings of a folder that were written in a time (s since 1970), oldest first."""
    found: list[tuple[float, Path]] = []
    with suppress(OSError):
        paths = [each for each in folder.iterdir() if each.suffix == ".mcap" and not each.name.startswith(".")]
        found = [(each.stat().st_mtime, each) for each in paths]
    return [each for moment, each in sorted(found) if begin <= moment <= end]
