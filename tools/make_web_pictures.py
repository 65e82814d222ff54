"""Make the pictures of the page of `ur web`, in docs/images, from the real page of a simulated robot. Needs Chromium.

Usage: tools/make_web_pictures.py [assistant]. It drives to a goal, and writes web_phone.png and web_desk.png when the
robot is on its way, first_drive.png, the page on a phone beside the terminal (docs/images/keyboard_navigate.svg), and
drive.gif, the page while the robot drives on to the goal, five times as fast as it was. With `assistant` it only writes
assistant_asks.png and assistant_phone.png, the page while an assistant asks to drive, and while it may.
"""

import base64
import io
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image

from ur.mcp.grants import GrantFiles, Request, ServerRecord, grant_files

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tests.chromium import Chromium, find_chromium
from tests.ros_session import free_port
from tools.pictures import IMAGES, ROOT, save, wait_until

PHONE, DESK, MOVING = (390, 844), (1200, 750), (840, 525)
EVERY, SHOWN_FOR = 0.5, 100  # s between the frames of drive.gif; ms that each is shown
GOAL = "g 12.1 7.65 90"  # that of tools/make_screenshot.py
LIMIT = 120.0  # s
COLOURS = 96
ASSISTANT = "0123abcd"  # the id of its server
_SHOWN = "globalThis.page?.map.tiles.tiles.size && page.map.pose && page.map.scan.length > 50 && page.drive.newest"
_THERE = "page.map.plan?.length > 1 && page.pose.x > 13.2 && page.pose.y < 1.5"  # where the terminal's robot is


def main() -> None:
    """Write the pictures."""
    program = find_chromium()
    if program is None:
        raise SystemExit("error: Chromium is not installed; apt-get install chromium-headless-shell")
    with tempfile.TemporaryDirectory() as name, _robot(Path(name)) as (link, drive):
        _take_pictures(program, Path(name), link, drive)


def _take_pictures(program: str, folder: Path, link: str, drive: Callable[[str], None]) -> None:
    with Chromium(program, folder / "chromium") as browser:
        browser.resize(*PHONE, phone=True)
        browser.open(link)
        wait_until(lambda: browser.run(f"Boolean({_SHOWN})"), "a robot on the page")
        if "assistant" in sys.argv:
            _take_assistant(browser, grant_files({"HOME": str(folder)}))
            return
        drive(GOAL)
        wait_until(lambda: browser.run(f"Boolean({_THERE})"), "a robot on its way")
        phone = browser.screenshot()
        _save(phone, IMAGES / "web_phone.png")
        browser.resize(*DESK)
        time.sleep(1.0)  # one more picture of the map
        _save(browser.screenshot(), IMAGES / "web_desk.png")
        browser.resize(*MOVING)
        time.sleep(1.0)
        _save_moving(_film(browser), IMAGES / "drive.gif")
        beside = folder / "beside.html"
        beside.write_text(_page_beside_terminal(phone))
        browser.resize(1260, 690)
        browser.open(beside.as_uri())
        _save(browser.screenshot(), IMAGES / "first_drive.png")


def _take_assistant(browser: Chromium, files: GrantFiles) -> None:
    """Take the page while an assistant asks to drive on a desk, and on a phone while it may."""
    panel = "document.getElementById('assistants-panel')"
    asks = Request(30.0, 0.2, "to look at the door")
    files.note_server(ASSISTANT, ServerRecord(os.getpid(), "Helper", asks))
    browser.resize(*DESK)
    wait_until(lambda: "asks to drive" in browser.run("document.querySelector('#banners').innerText"), "an assistant")
    browser.run("page.panels.toggle('assistants'); 0")
    for index, value in enumerate((3.0, 6.0, 2.0, 4.0)):
        field = f"{panel}.querySelectorAll('.rectangle .sides input')[{index}]"
        browser.run(f"{field}.value = '{value}'; {field}.dispatchEvent(new Event('input')); 0")
    browser.run(f"{panel}.querySelector('fieldset > input').value = 'kitchen'; 0")
    browser.run(f"[...{panel}.querySelectorAll('button')].find((e) => e.textContent === 'Not here').click(); 0")
    time.sleep(1.0)  # one more picture of the map
    _save(browser.screenshot(), IMAGES / "assistant_asks.png")
    browser.run(f"{panel}.querySelector('form').requestSubmit(); 0")
    wait_until(lambda: files.find(ASSISTANT) is not None, "a grant")
    browser.run("page.panels.toggle('assistants'); 0")
    browser.resize(*PHONE, phone=True)
    wait_until(lambda: "may drive" in browser.run("document.querySelector('#banners').innerText"), "a banner")
    browser.run("page.map.fit(); 0")
    time.sleep(1.0)
    _save(browser.screenshot(), IMAGES / "assistant_phone.png")
    files.forget_server(ASSISTANT)


@contextmanager
def _robot(folder: Path) -> Iterator[tuple[str, Callable[[str], None]]]:
    """A simulated robot and its page: the link, and a function that gives keyboard_navigate a command."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("ROS", "WAYLAND", "DISPLAY"))}
    environment = {**kept, "HOME": str(folder), "ROS_MASTER_URI": f"http://localhost:{free_port()}"}
    run = subprocess.Popen(
        [ROOT / "ur", "run", "keyboard_navigate", "simulate:=true"],
        env=environment, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    log = folder / "web.log"
    with log.open("w") as output:
        command = [str(ROOT / "ur"), "web", "--port", str(free_port()), "--no-browser"]
        web = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=output)
    try:
        wait_until(lambda: "login#" in log.read_text(), "a link of ur web")
        found = re.search(r"http\S+", log.read_text())
        assert found
        assert run.stdin
        stdin = run.stdin

        def drive(command: str) -> None:
            stdin.write(f"{command}\n")
            stdin.flush()

        yield found[0], drive
    finally:
        for process in (web, run):
            process.terminate()
            process.wait()


def _page_beside_terminal(phone: bytes) -> str:
    terminal = (IMAGES / "keyboard_navigate.svg").read_text(encoding="utf-8")
    source = f"data:image/png;base64,{base64.b64encode(phone).decode()}"
    return (
        "<!doctype html><style>body{margin:20px;display:flex;gap:24px;align-items:center;background:#fff}"
        "svg{width:900px;height:auto}img{height:590px;border:5px solid #222;border-radius:26px}</style>"
        f"{terminal}<img src='{source}' alt=''>"
    )


def _film(browser: Chromium) -> list[bytes]:
    """Screenshots of the page until the robot is at its goal, and two seconds more."""
    frames: list[bytes] = []
    begin, more = time.monotonic(), 4
    while more and time.monotonic() - begin < LIMIT:
        frames.append(browser.screenshot())
        more -= not browser.run("Boolean(page.map.plan?.length > 1)")
        time.sleep(max(begin + len(frames) * EVERY - time.monotonic(), 0.0))
    return frames


def _save_moving(frames: list[bytes], path: Path) -> None:
    pictures = [Image.open(io.BytesIO(png)).convert("RGB") for png in frames]
    palette = pictures[-1].quantize(COLOURS, dither=Image.Dither.NONE)
    first, *others = (picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures)
    first.save(path, save_all=True, append_images=others, duration=SHOWN_FOR, loop=0, optimize=True)
    print(f"{path.relative_to(ROOT)}: {len(frames)} frames, {path.stat().st_size // 1024} kB")


def _save(png: bytes, path: Path) -> None:
    save(Image.open(io.BytesIO(png)).convert("RGB"), path, COLOURS)


if __name__ == "__main__":
    main()
