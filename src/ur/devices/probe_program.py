"""Program that identifies serial devices; it uses only the standard library, and also runs on a robot.

The argument is a JSON list of [path, kind of query, baud rate]. Prints a JSON mapping of path to answer.

- `rplidar`: the request GET_INFO (A5 50) of Slamtec's protocol, answered with model, firmware, hardware and number.
- `neato`: the command GetVersion of Neato's programmer's manual, answered with a table.
- `xv11`: nothing is sent; the lidar sends packets of 22 bytes by itself, which begin with FA.
"""

import errno
import fcntl
import json
import os
import select
import sys
import termios
import time
import tty
from collections.abc import Callable
from contextlib import suppress

WAIT = 1.5  # s
PACKET = 22  # bytes of an XV-11


def main() -> None:
    """Query each path in turn; a path that has answered is not queried again."""
    answers: dict[str, str] = {}
    for path, kind, baud in json.loads(sys.argv[1]):
        if not answers.get(path):
            try:
                answers[path] = ask(path, kind, baud)
            except OSError as problem:
                state = "cannot be opened" if problem.filename else "cannot be asked"
                answers[path] = f"{state}: {problem.strerror}"
    sys.stdout.write(json.dumps(answers) + "\n")


def ask(path: str, kind: str, baud: int) -> str:
    """Query one device. Raises OSError."""
    line = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        fcntl.ioctl(line, termios.TIOCEXCL)
        before = termios.tcgetattr(line)
        try:
            tty.setraw(line)
            mode = termios.tcgetattr(line)
            mode[2] |= termios.CLOCAL
            mode[4] = mode[5] = getattr(termios, f"B{baud}", termios.B115200)
            termios.tcsetattr(line, termios.TCSANOW, mode)
            termios.tcflush(line, termios.TCIOFLUSH)
            return {"rplidar": _ask_rplidar, "neato": _ask_neato, "xv11": _read_xv11}[kind](line)
        finally:
            with suppress(OSError, termios.error):  # unplugged
                termios.tcsetattr(line, termios.TCSANOW, before)
                fcntl.ioctl(line, termios.TIOCNXCL)
    except termios.error as problem:
        raise OSError(*problem.args) from None
    finally:
        os.close(line)


def _ask_rplidar(line: int) -> str:
    os.write(line, b"\xa5\x50")
    data = _read(line, lambda data: _after(data, b"\xa5\x5a\x14\x00\x00\x00\x04", 20) is not None)
    answer = _after(data, b"\xa5\x5a\x14\x00\x00\x00\x04", 20)
    if answer is None:
        return ""
    number = answer[4:20].hex().upper()
    return f"RPLIDAR model {answer[0] >> 4}.{answer[0] & 15}, firmware {answer[2]}.{answer[1]:02d}, number {number}"


def _ask_neato(line: int) -> str:
    os.write(line, b"GetVersion\n")
    text = _read(line, lambda data: b"\x1a" in data).decode("ascii", "replace")
    rows = {row.split(",")[0]: row.split(",")[1:] for row in text.splitlines() if "," in row}
    if "Component" not in rows:
        return ""
    model = next((rows[key][0] for key in ("ModelID", "Model") if key in rows), "")
    return f"Neato {model}, software {'.'.join(rows['Software'][:3])}" if "Software" in rows else f"Neato {model}"


def _read_xv11(line: int) -> str:
    data = _read(line, lambda data: _count_packets(data) >= 3)
    return "XV-11 lidar, packets arrive" if _count_packets(data) >= 3 else ""


def _count_packets(data: bytes) -> int:
    """Return the number of packets with a valid checksum (sum of 10 words, doubled each time, of 15 bits)."""
    count, at = 0, 0
    while (at := data.find(b"\xfa", at)) >= 0 and at + PACKET <= len(data):
        packet = data[at : at + PACKET]
        total = 0
        for index in range(10):
            total = (total << 1) + packet[2 * index] + (packet[2 * index + 1] << 8)
        total = ((total & 0x7FFF) + (total >> 15)) & 0x7FFF
        good = packet[20] + (packet[21] << 8) == total
        count, at = count + good, at + (PACKET if good else 1)
    return count


def _after(data: bytes, head: bytes, size: int) -> bytes | None:
    at = data.find(head)
    body = data[at + len(head) : at + len(head) + size]
    return body if at >= 0 and len(body) == size else None


def _read(line: int, done: Callable[[bytes], bool]) -> bytes:
    end, data = time.monotonic() + WAIT, b""
    while (left := end - time.monotonic()) > 0 and not done(data) and len(data) < 65536:
        if select.select([line], [], [], left)[0]:
            more = os.read(line, 4096)
            if not more:
                raise OSError(errno.ENODEV, "it was unplugged")
            data += more
    return data


if __name__ == "__main__":
    main()
