#!/usr/bin/env python3
"""Try the page of a run: tests/fresh/page.py PORT [LIMIT]. It starts a robot and `ur web`, logs in, and
waits for frames.

Run it with .venv/bin/python. Prints the time until the first frame with data.
"""

import asyncio
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

UR = str(Path(__file__).resolve().parents[2] / "ur")
LIMIT = float(sys.argv[2]) if len(sys.argv) > 2 else 120.0  # s
FRAMES = 10  # with content of more than a header


async def receive(port: int, log: Path) -> str:
    """Log in with the link in a file, and receive frames of the view."""
    begin = time.monotonic()
    while not (found := re.search(r"login#(\S+)", log.read_text())):
        assert time.monotonic() - begin < LIMIT, log.read_text()
        await asyncio.sleep(0.2)
    import aiohttp  # installed by `ur web`, which has printed its link

    url, count = f"http://localhost:{port}", 0
    begin = time.monotonic()
    async with aiohttp.ClientSession() as session:
        (await session.post(f"{url}/login", json={"token": found[1]}, headers={"Origin": url})).raise_for_status()
        async with session.ws_connect(f"{url}/ws/view?tab=0123456789", headers={"Origin": url}) as view:
            while count < FRAMES:
                message = await asyncio.wait_for(view.receive(), LIMIT)
                assert message.type == aiohttp.WSMsgType.BINARY, message
                count += len(message.data) > 30
    return f"{count} frames of the page in {time.monotonic() - begin:.1f} s"


def main() -> int:
    """Start both, and end them."""
    port = int(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "web"
        with log.open("w") as output:
            robot = subprocess.Popen([UR, "run", "robot_base"], stdout=subprocess.DEVNULL)
            web = subprocess.Popen([UR, "web", "--no-browser", "--port", str(port)], stdout=output, stderr=output)
            try:
                print(asyncio.run(receive(port, log)))  # noqa: T201 - the answer of this program
            finally:
                for process in (web, robot):
                    process.send_signal(signal.SIGINT)
                    try:
                        process.wait(LIMIT)
                    except subprocess.TimeoutExpired:
                        process.kill()
                        raise
    return 0


if __name__ == "__main__":
    sys.exit(main())
