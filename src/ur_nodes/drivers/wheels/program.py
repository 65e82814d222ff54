"""Test the wheels of a base off the ground, in a terminal; the program of `ur robot wheels`.

It opens the board itself, so the robot's driver may not run. A guard process stops the motors if this one dies.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import select
import sys
import termios
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

from ur.robot.base import Base, load_base
from ur.robot.base.wiring import write_wiring
from ur.source.diagnostic import UserError, error
from ur.source.render import render_human, shows_colour
from ur_nodes.drivers.boards.board import MotorBoard
from ur_nodes.drivers.lines.line import LineSettings
from ur_nodes.drivers.lines.motor_guard import MotorGuard, start_guard
from ur_nodes.drivers.lines.serial_line import open_port
from ur_nodes.drivers.registry import BOARDS
from ur_nodes.drivers.wheels.session import WheelSession
from ur_nodes.drivers.wheels.verdict import MOTIONS, SIDES, WheelObservation, WheelVerdict, judge

_DIRECTIONS = {"f": 1, "b": -1, "n": 0}
_TRIES = 3  # answers that are none, after which the test ends
_MOST = 65536

Ask = Callable[[str], str]
Say = Callable[[str], None]


class GuardedLine:
    """See TimedLine: a serial device, for as long as the context lasts. Its board is stopped and left at the end."""

    def __init__(self, path: str, board: MotorBoard, baud: int) -> None:
        """Open it. Raises UserError."""
        self.name, self._board = path, board
        port = open_port(path, LineSettings(baud or board.baud))
        if isinstance(port, str):
            text = f"{path} cannot be opened ({port}), expected {board.name}; is it unplugged, or does its driver run?"
            help_ = "stop the robot's programs (ur stop, ur boot), and see: ur devices"
            raise UserError(error(text, rule="no-device", help=help_))
        self._port = port
        self._guard = MotorGuard(port.fileno(), board.stop(), board.shutdown(), start_guard)

    def __enter__(self) -> GuardedLine:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: object, trace: TracebackType | None) -> None:
        with contextlib.suppress(OSError, termios.error):
            os.write(self._port.fileno(), self._board.stop() + self._board.shutdown())
            termios.tcdrain(self._port.fileno())
        self._guard.close()  # it stops the board once more, and ends
        with contextlib.suppress(OSError, termios.error):
            self._port.close()

    def time(self) -> float:
        return time.monotonic()

    def exchange(self, data: bytes, seconds: float, *, moving: bool) -> bytes:
        end, received, device = time.monotonic() + seconds, b"", self._port.fileno()
        try:
            self._guard.report(moving=moving)
            os.write(device, data)
            while select.select([device], [], [], max(0.0, end - time.monotonic()))[0]:
                part = os.read(device, _MOST)
                received += part
                if not part:
                    raise OSError
        except OSError:
            text = f"{self.name} was unplugged, expected {self._board.name}"
            raise UserError(error(text, rule="no-device", help="plug it in, and run this again")) from None
        return received


def run_test(session: WheelSession, ask: Ask, say: Say) -> WheelVerdict | None:
    """Ask, turn the wheels four times, and compare; None where the person does not want it. Raises UserError."""
    question = "The wheels will turn. Does the robot stand with all its wheels off the ground? [y/N] "
    if ask(question).strip().lower() not in ("y", "yes"):
        return None
    observations = []
    for motion in MOTIONS:
        ask(f"Press Enter, and watch the wheels: {motion.name} ")
        session.wait()
        counted = session.turn(motion)
        say("  counted: " + ", ".join(f"{side} {metres:+.3f} m" for side, metres in zip(SIDES, counted, strict=True)))
        expected = [
            f"{side} {'forward' if sign > 0 else 'back'}" for side, sign in zip(SIDES, motion.signs, strict=True)
        ]
        right = ask(f"  Did the wheels turn so: {', '.join(expected)}? [Y/n] ").strip().lower() in ("", "y", "yes")
        observations.append(WheelObservation(motion, motion.signs if right else _ask_directions(ask), counted))
    return judge(observations)


def _ask_directions(ask: Ask) -> tuple[int, int]:
    left, right = (_ask_direction(ask, side) for side in SIDES)
    return left, right


def _ask_direction(ask: Ask, side: str) -> int:
    for _ in range(_TRIES):
        answer = ask(f"  How did the robot's {side} wheel turn: [f]orward, [b]ack, [n]ot at all? ").strip().lower()[:1]
        if answer in _DIRECTIONS:
            return _DIRECTIONS[answer]
    raise UserError(error("no answer, expected f, b or n; nothing was changed", rule="no-answer"))


def report(verdict: WheelVerdict, path: Path, base: Base, say: Say) -> int:
    """Print the verdict, and put its wiring into the base file; return the exit code. Raises UserError."""
    for problem in verdict.problems:
        say(f"problem: {problem}")
    if verdict.wiring is None:
        return 1
    assert base.driver
    if verdict.wiring == base.driver.wiring:
        say("ok: the wheels turn and count as the base file says")
        return 1 if verdict.problems else 0
    differs = ", ".join(name.replace("_", " ") for name in verdict.wiring.names) or "nothing is swapped or reversed"
    try:
        write_wiring(path, base.variant, verdict.wiring)
    except (OSError, LookupError) as problem:
        wires = ", ".join(f"{name}: true" for name in verdict.wiring.names)
        text = f"{differs}; {path} cannot be written ({problem})"
        raise UserError(error(text, rule="no-file", help=f"add to its driver: wiring: {{{wires}}}")) from None
    say(f"{differs}: written to {path}; the driver takes it at its next start")
    return 1 if verdict.problems else 0


def main(argv: list[str], ask: Ask, say: Say) -> int:
    """Run the test as the arguments say. Raises UserError."""
    parser = argparse.ArgumentParser(prog="ur robot wheels")
    for name in ("package", "base"):
        parser.add_argument(f"--{name}", required=True)
    for name in ("variant", "device"):
        parser.add_argument(f"--{name}", default="")
    given = parser.parse_args(argv)
    base = load_base(given.package, given.base, given.variant)
    driver = base.driver
    if driver is None or driver.protocol not in BOARDS:
        text = f"base {base.name!r} has no driver of this project, expected one of {', '.join(BOARDS)} as its driver"
        raise UserError(error(text, rule="no-device"))
    path, board = given.device or driver.device, BOARDS[driver.protocol](base)
    with GuardedLine(path, board, driver.baud) as line:
        session = WheelSession(line, board, base)
        session.wait()
        say(f"{path}: {board.name}: {session.firmware or 'it answers'}")
        verdict = run_test(session, ask, say)
    if verdict is None:
        say("nothing was turned")
        return 1
    return report(verdict, Path(given.package, "bases", base.name, "base.yaml"), base, say)


def run() -> int:
    """Run the test in this terminal; return the exit code."""
    try:
        if not sys.stdin.isatty():
            raise UserError(error("no terminal, expected a person who sees the wheels", rule="no-terminal"))
        return main(sys.argv[1:], input, print)
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics, colour=shows_colour(sys.stderr)))
        return 2
    except (KeyboardInterrupt, EOFError):
        sys.stderr.write("\nstopped; nothing was changed\n")
        return 130


if __name__ == "__main__":
    sys.exit(run())
