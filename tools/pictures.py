"""What the tools that make pictures of docs/images have in common: pictures by name, screens, and programs on them."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
PATIENCE = 300.0  # s; a busy computer draws slowly


def clean_svg(svg: str) -> str:
    """Return an SVG of a terminal that loads nothing from elsewhere, and is the same each time."""
    svg = re.sub(r"@font-face \{.*?\}\s*", "", svg, flags=re.DOTALL)
    svg = re.sub(r"<!--.*?-->\s*", "", svg, flags=re.DOTALL)
    return re.sub(r"terminal-\d+", "terminal", svg)


def save(made: Image.Image | str, path: Path, colours: int = 64) -> None:
    """Write an SVG, or a picture of a few colours, and print its size."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(made, str):
        path.write_text(made, encoding="utf-8")
    else:
        made.quantize(colours, dither=Image.Dither.NONE).save(path, optimize=True)
    print(f"{path}: {path.stat().st_size // 1024} kB")


def make_named(makers: Mapping[str, Callable[[], Image.Image | str]], names: Sequence[str], colours: int = 64) -> int:
    """Make the pictures with these names in docs/images, all without any. Returns the exit code."""
    unknown = [name for name in names if name not in makers]
    if unknown:
        print(f"error: {unknown[0]!r} is not known, expected one of {', '.join(makers)}", file=sys.stderr)
        return 2
    for name in names or makers:
        made = makers[name]()
        save(made, IMAGES / f"{name}.{'svg' if isinstance(made, str) else 'png'}", colours)
    return 0


def read_size(words: Sequence[str], default: str) -> tuple[tuple[int, int], bool]:
    """Read `[COLUMNSxROWS] [dark|light]`: the size, and whether it is light. The clock is UTC from now on."""
    os.environ["TZ"] = "UTC"
    time.tzset()
    columns, rows = (words[0] if words else default).split("x")
    return (int(columns), int(rows)), words[1:] == ["light"]


@contextmanager
def start_screen(folder: Path, width: int, height: int) -> Iterator[dict[str, str]]:
    """Start a screen that nobody sees; yield the environment in which programs of ROS find it."""
    reader, writer = os.pipe()
    screen = subprocess.Popen(
        # Without -noreset it begins anew, and refuses whoever comes then, each time a look at it ends.
        ["Xvfb", "-displayfd", str(writer), "-screen", "0", f"{width}x{height}x24", "-nolisten", "tcp", "-noreset"],
        pass_fds=[writer],
        stderr=subprocess.DEVNULL,
    )
    os.close(writer)
    with os.fdopen(reader) as answer:
        display = f":{answer.readline().strip()}"
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("ROS", "WAYLAND"))}
    own = {"DISPLAY": display, "HOME": str(folder), "XDG_RUNTIME_DIR": str(folder), "LIBGL_ALWAYS_SOFTWARE": "1"}
    try:
        yield kept | own
    finally:
        end(screen)


def wait_until(condition: Callable[[], object], what: str, seconds: float = PATIENCE) -> None:
    """Wait for a condition. Raises SystemExit when it does not come true."""
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise SystemExit(f"error: {what} did not appear within {seconds:.0f} s")
        time.sleep(0.05)


def end(process: subprocess.Popen[bytes]) -> None:
    """End a process that we started."""
    process.send_signal(signal.SIGTERM)
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
