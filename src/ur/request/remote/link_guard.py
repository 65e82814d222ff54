"""Program that guards a connection, on the robot: one file that uses only the standard library.

It prints a number every PERIOD s, and reads the returned ones. A returned number proves that the connection worked when
it was sent: that time (s, monotonic) is written to the file that is its argument, and the program beside it drives only
while it is recent. It ends with its connection, and removes the file.
"""

import os
import select
import struct
import sys
import time
from contextlib import suppress

PERIOD = 0.03
MOST_WAITING = 100
_PROOF = struct.Struct("d")


def guard(path: str, source: int, target: int) -> None:
    """Send and read numbers until the other end closes."""
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o600)
    sent: dict[int, float] = {}
    rest, number, due = b"", 0, time.monotonic()
    os.set_blocking(target, False)
    try:
        while True:
            now = time.monotonic()
            if now >= due:
                number, due = number + 1, now + PERIOD
                sent[number] = now
                if len(sent) > MOST_WAITING:  # nothing of this age is a proof
                    del sent[min(sent)]
                with suppress(BlockingIOError):
                    os.write(target, b"%d\n" % number)
            if not select.select([source], [], [], max(0.0, due - time.monotonic()))[0]:
                continue
            data = os.read(source, 4096)
            if not data:
                return
            *lines, rest = (rest + data)[-4096:].split(b"\n")
            proofs = [sent.pop(int(line)) for line in lines if line.isdigit() and int(line) in sent]
            if proofs:
                os.pwrite(descriptor, _PROOF.pack(max(proofs)), 0)
    except BrokenPipeError:
        return
    finally:
        os.close(descriptor)
        os.unlink(path)  # noqa: PTH108 - the program is small, and starts fast


if __name__ == "__main__":
    guard(sys.argv[1], sys.stdin.fileno(), sys.stdout.fileno())
