"""Stop motors when the driver can no longer; runs alone, with the standard library only.

Arguments: a pipe, the device (both open), the bytes that stop the motors, those with which the device is left, in
hexadecimal, and the control group (cgroup v2) above that of the run, or ''. Without arguments a socket unit of systemd
has started it for the driver behind standard input, which sends the device and both texts in its first message.

The driver writes `m` with each command that turns motors and `r` with each that does not. After an `m` that no other
byte follows within LIMIT the motors are stopped; at the end of the pipe they are, and the device is left. Nothing but
that ends this process. It leaves what is killed together with the driver, and has the lowest OOM score that it may set.
"""

import bisect
import contextlib
import os
import select
import signal
import sys

LIMIT = 0.15  # s
NAME = "ur-motor-guard"  # ur.run.host.descendants.MOTOR_GUARD
_SYSTEMD = ("org.freedesktop.systemd1", "/org/freedesktop/systemd1", "org.freedesktop.systemd1.Manager")
_START_UNIT = (*_SYSTEMD, "StartTransientUnit", "ssa(sv)a(sa(sv))")


def main(pipe: int, device: int, stop: bytes, shutdown: bytes = b"") -> None:
    """Watch until the driver has closed the pipe."""
    moving = False
    while True:
        if not select.select([pipe], [], [], LIMIT if moving else None)[0]:
            write(device, stop)
            moving = False
            continue
        data = os.read(pipe, 4096)
        if not data:
            write(device, stop + shutdown)
            return
        moving = data.endswith(b"m")


def write(device: int, data: bytes) -> None:
    """Send bytes, to a device that may be unplugged."""
    with contextlib.suppress(OSError):
        os.write(device, data)


def outlive() -> None:
    """Ignore the signals that end a driver, and make the OOM killer choose the driver before this process."""
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    put("/proc/self/comm", NAME)
    scores = range(-1000, 1001)
    lowest = scores[bisect.bisect_left(scores, True, key=lambda score: put("/proc/self/oom_score_adj", f"{score}"))]
    with contextlib.suppress(OSError, ValueError):
        driver = f"/proc/{os.getppid()}/oom_score_adj"
        with open(driver, encoding="ascii") as file:  # noqa: PTH123 - pathlib doubles the start-up time
            if int(file.read()) <= lowest:
                put(driver, f"{lowest + 1}")


def exit_unit(above: str) -> None:
    """Leave the control group of the run, and then, where systemd permits it, the unit that the run is in.

    Root asks the system's manager for a scope, another user its own; without one this process stays in `above`.
    """
    if above:
        put(f"{above}/cgroup.procs", f"{os.getpid()}")
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # subprocess would double the start-up time, too
    os.environ.setdefault("XDG_RUNTIME_DIR", f"/run/user/{os.getuid()}")
    user = ["--user"] if os.getuid() else []
    pid = f"{os.getpid()}"
    scope = (f"motor-guard-{pid}.scope", "fail", "1", "PIDs", "au", "1", pid, "0")
    with contextlib.suppress(OSError):
        os.spawnlp(os.P_NOWAIT, "busctl", "busctl", *user, "call", *_START_UNIT, *scope)  # noqa: S606 - likewise


def put(path: str, text: str) -> bool:
    """Write to a file of the kernel; return whether it took that."""
    try:
        with open(path, "w", encoding="ascii") as file:  # noqa: PTH123 - likewise
            file.write(text)
    except OSError:
        return False
    return True


def accept() -> tuple[int, int, bytes, bytes]:
    """Receive the driver's first message; return the arguments of `main`. Raises ValueError."""
    import socket

    data, devices, *_ = socket.recv_fds(socket.socket(fileno=os.dup(0)), 4096, 1)
    stop, shutdown = map(bytes.fromhex, data.decode("ascii").split(","))
    return 0, devices[0], stop, shutdown


if __name__ == "__main__":
    outlive()
    if len(sys.argv) > 1:
        exit_unit(sys.argv[5])
        main(int(sys.argv[1]), int(sys.argv[2]), *map(bytes.fromhex, sys.argv[3:5]))
    else:
        main(*accept())
