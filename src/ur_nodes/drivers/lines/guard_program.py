"""Stop motors when the driver can no longer; runs alone, with the standard library only.

Arguments: a pipe, the device (both open), the bytes that stop the motors, and those with which the device is left, in
hexadecimal. The driver writes `m` with each command that turns motors and `r` with each that does not. After an `m`
that no other byte follows within LIMIT the motors are stopped; at the end of the pipe they are, and the device is left.
"""

import contextlib
import os
import select
import sys

LIMIT = 0.15  # s


def main(pipe: int, device: int, stop: bytes, leave: bytes = b"") -> None:
    """Watch until the driver has closed the pipe."""
    moving = False
    while True:
        if not select.select([pipe], [], [], LIMIT if moving else None)[0]:
            write(device, stop)
            moving = False
            continue
        data = os.read(pipe, 4096)
        if not data:
            write(device, stop + leave)
            return
        moving = data.endswith(b"m")


def write(device: int, data: bytes) -> None:
    """Send bytes, to a device that may be unplugged."""
    with contextlib.suppress(OSError):
        os.write(device, data)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), *map(bytes.fromhex, sys.argv[3:]))
