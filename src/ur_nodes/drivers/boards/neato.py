"""Neato XV-11 and Botvac D3 to D85: "Neato Robotics Programmer's Manual", ASCII commands over USB.

A command is a line; its answer begins with the line itself and ends with 1A. Test mode is needed to move wheels and to
turn the lidar. `SetMotor` takes distances (mm) and the speed of the wheel that goes farther; both arrive together. Each
command here lasts 0.2 to 0.35 s, and the robot rests after the last one. It takes no distance of 0 for both
wheels; so a stop is 1 mm at 1 mm/s, to and fro (as package neato_robot does). The lidar's answer is a table of a turn,
counter-clockwise from straight ahead.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base
from ur_nodes.drivers.lidars.turning_head import TurningHead
from ur_nodes.drivers.readings import (
    NOT_MEASURED,
    Contacts,
    Counts,
    DeviceIdentity,
    MeasuredBeams,
    Motors,
    Power,
    Reading,
)

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.plant import Plant

FASTEST = 300  # mm/s
SHORTEST, LONGEST = 0.2, 0.35  # s that a command lasts
CLIFF = 80.0  # mm to the floor; on the floor sensors give 0 to 60. A guess: the manual names no limit
_END = b"\x1a"
_MOST = 16384  # bytes of an answer: that of the lidar has 7,000
_SLOWEST = 0.5  # mm/s
_STOPS = 3  # times that a stop is sent
_PATIENCE = 10  # beats without an answer, after which the next question is sent
_TURN = 4  # beats in which each question is asked; the battery's less often
_SECONDS = 5  # turns between two questions for the battery
_BEAMS = 360
_FEWEST = 180  # beams of a table that is used
_REACH = 16.0  # m; what is beyond is the number of an error
_BEAM = re.compile(r"^(\d{1,3}),(\d{1,5}),(\d{1,5}),([0-9A-Fa-f]{1,4})[ \r]*$", re.MULTILINE)
_RATE = re.compile(r"^ROTATION_SPEED, *(\d{1,2}(?:\.\d{1,3})?)[ \r]*$", re.MULTILINE)
_BUMPERS = {"LSIDEBIT": "left_side", "LFRONTBIT": "left_front", "RFRONTBIT": "right_front", "RSIDEBIT": "right_side"}
_CLIFFS = {"LeftDropInMM": "left", "RightDropInMM": "right", "DropSensorLeft": "left", "DropSensorRight": "right"}
_MOTORS, _SCAN, _SWITCHES, _FLOOR, _CHARGER = (
    "GetMotors LeftWheel RightWheel", "GetLDSScan", "GetDigitalSensors", "GetAnalogSensors", "GetCharger"
)  # fmt: skip
_AGENDA = ((_SCAN,), (_SWITCHES, _FLOOR), (_SCAN,), (_SWITCHES,))
"""The questions of each beat: the table of the lidar twice in a turn, since what differs tells where its head is."""


class Neato:
    """See MotorBoard."""

    name = "Neato Botvac or XV-11"
    baud = 115200
    period = 0.05

    def __init__(self, base: Base) -> None:
        self.counts_per_turn = 2.0 * math.pi * base.wheels.radius * 1000.0
        self._capacity = base.battery.design_capacity if base.battery else NOT_MEASURED
        self._buffer = b""
        self._beats = self._waiting = self._stops = 0
        self._asked = False
        self._over = (0.0, 0.0)  # mm/s that the last commands left out
        self._back = False  # direction of the next stop
        self.rejected = 0

    def handshake(self) -> bytes:
        """Test mode, the lidar's motor, and the question for its version."""
        self._asked = False
        return _line("") + _line("TestMode On") + _line("SetLDSRotation On") + _line("GetVersion")

    def drive(self, left: float, right: float) -> bytes:
        self._beats += 1
        return self._move(left * 1000.0, right * 1000.0) + self._ask()

    def stop(self) -> bytes:
        """See MotorBoard. The empty line ends a command that was cut off."""
        return _line("") + _line("SetMotor LWheelDist 1 RWheelDist 1 Speed 1")

    def shutdown(self) -> bytes:
        """Its buttons work again, and the lidar rests."""
        return _line("SetLDSRotation Off") + _line("TestMode Off")

    def receive(self, data: bytes) -> Iterator[Reading]:
        *answers, self._buffer = (self._buffer + data).split(_END)
        self._buffer = self._buffer[-_MOST:]
        for answer in answers:
            self._asked = False
            asked = answer.count(b"Get")
            self.rejected += not answer.isascii() or asked > 1 or (asked == 1 and b"," not in answer)
            yield from self._read(answer.decode("ascii", "replace"))

    def _move(self, left: float, right: float) -> bytes:
        """The command for speeds of the wheels, mm/s."""
        wanted = [
            max(-FASTEST, min(FASTEST, speed + over)) if math.isfinite(speed) and abs(speed) >= _SLOWEST else 0.0
            for speed, over in zip((left, right), self._over, strict=True)
        ]
        speed = round(max(abs(each) for each in wanted))
        if not speed:
            self._over = (0.0, 0.0)
            self._stops += 1
            self._back = not self._back
            step = -1 if self._back else 1
            return _line(f"SetMotor LWheelDist {step} RWheelDist {step} Speed 1") if self._stops <= _STOPS else b""
        self._stops = 0
        distances = _divide(wanted, speed)
        farthest = max(abs(distance) for distance in distances)
        given = [speed * distance / farthest for distance in distances]
        over_left, over_right = (max(-5.0, min(5.0, w - g)) for w, g in zip(wanted, given, strict=True))
        self._over = (over_left, over_right)
        return _line("SetMotor LWheelDist {} RWheelDist {} Speed {}".format(*distances, speed))

    def _ask(self) -> bytes:
        """The questions of this beat; none while the answers of the last ones are on their way."""
        self._waiting = self._waiting + 1 if self._asked else 0
        if 0 < self._waiting <= _PATIENCE:
            return b""
        self._waiting, self._asked = 0, True
        charger = (_CHARGER,) if self._beats % (_TURN * _SECONDS) == 0 else ()
        return b"".join(map(_line, (*_AGENDA[self._beats % _TURN], *charger, _MOTORS)))

    def _read(self, answer: str) -> Iterator[Reading]:
        if rate := _RATE.search(answer):
            yield from _read_scan(answer, float(rate[1]))
            return
        lines = [line.strip() for line in answer.splitlines()]
        cells = {line.split(",")[0]: [cell.strip() for cell in line.split(",")[1:]] for line in lines if "," in line}
        left, right = (_number(cells, f"{side}Wheel_PositionInMM") for side in ("Left", "Right"))
        if not (math.isnan(left) or math.isnan(right)):
            yield Counts(round(left), round(right))
        if "LSIDEBIT" in cells:
            yield Contacts("bumper", tuple((name, _number(cells, key) == 1.0) for key, name in _BUMPERS.items()))
            lifted = any(_number(cells, f"SNSR_{side}_WHEEL_EXTENDED") == 1.0 for side in ("LEFT", "RIGHT"))
            yield Motors(not lifted, "a wheel hangs in the air" if lifted else "")
        floor = {name: _number(cells, key) for key, name in _CLIFFS.items() if key in cells}
        if floor:
            yield Contacts("cliff", tuple((name, depth > CLIFF) for name, depth in floor.items()))
        if "VBattV" in cells:
            charge = _number(cells, "FuelPercent") / 100.0 * self._capacity
            charging = _number(cells, "ChargingActive") == 1.0
            yield Power(_number(cells, "VBattV"), NOT_MEASURED, charge, self._capacity, charging)
        if "ModelID" in cells:
            model = next((cell for cell in cells["ModelID"] if re.fullmatch(r"[A-Z]\w{1,20}", cell)), "of no model")
            software = ".".join(cell for cell in cells.get("Software", ()) if cell.isdigit())
            yield DeviceIdentity(f"{model}, software {software or 'unknown'}")


def _line(text: str) -> bytes:
    return text.encode() + b"\n"


def _divide(speeds: list[float], fastest: int) -> list[int]:
    """Distances in whole mm that are to each other as speeds are, as well as a command of a good length can have it."""
    shares = [each / max(abs(speed) for speed in speeds) for each in speeds]
    least = max(1, math.ceil(SHORTEST * fastest))
    longest = max(least, int(LONGEST * fastest))
    pairs = [[round(share * distance) for share in shares] for distance in range(least, longest + 1)]

    def deviate(pair: list[int]) -> float:
        return sum(abs(each / max(map(abs, pair)) - share) for each, share in zip(pair, shares, strict=True))

    return min(pairs, key=deviate)


def _number(cells: Mapping[str, list[str]], key: str) -> float:
    """The last number of a line by its name; NaN where there is none."""
    for cell in reversed(cells.get(key, [])):
        if re.fullmatch(r"-?\d{1,10}(\.\d{1,6})?", cell):
            return float(cell)
    return NOT_MEASURED


def _read_scan(answer: str, rate: float) -> Iterator[Reading]:
    rows = np.array([(int(a), int(b), int(c), int(d, 16)) for a, b, c, d in _BEAM.findall(answer)]).reshape(-1, 4)
    rows = rows[rows[:, 0] < _BEAMS]
    if len(rows) < _FEWEST or rate <= 0.0:
        return
    ranges, brightness = np.full(_BEAMS, np.inf), np.zeros(_BEAMS)
    metres = rows[:, 1] / 1000.0
    ranges[rows[:, 0]] = np.where((rows[:, 3] == 0) & (metres > 0.0) & (metres < _REACH), metres, np.inf)
    brightness[rows[:, 0]] = rows[:, 2]
    yield MeasuredBeams(np.radians(np.arange(_BEAMS)), ranges, brightness, turn_time=1.0 / rate, complete=True)


# Stand-in: a Neato robot's USB console, from the tables of the "Neato Programmer's Manual" (2014) and its worked
# answers. Commands are matched by as many letters as make them unique, without regard to case, as the manual says.

COMMANDS = ("GetAccel", "GetAnalogSensors", "GetButtons", "GetCharger", "GetDigitalSensors", "GetErr", "GetLDSScan",
            "GetMotors", "GetVersion", "Help", "PlaySound", "SetLDSRotation", "SetLED",
            "SetMotor", "TestMode")  # fmt: skip
_FASTEST = 300


class _Head(TurningHead):
    """Its lidar: what it measured last in each direction."""

    clockwise = False
    turns = False

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self.table = np.zeros(360)

    def receive(self, data: bytes) -> bytes:
        raise NotImplementedError

    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        self.table[beams % 360] = millimetres
        return b""


class NeatoFirmware:
    """See Firmware. `lifted`: its wheels hang in the air; `counted` begins its counters, mm."""

    covers = frozenset(("battery", "bumpers", "cliffs", "lidar"))

    def __init__(self, plant: Plant, *, counted: int = 0) -> None:
        self._plant, self._counted = plant, counted
        self._head = _Head(plant) if plant.base.lidar else None
        self._text = ""
        self._until = -math.inf
        self.test_mode = self.lifted = False

    def receive(self, data: bytes) -> bytes:
        self._turn()
        *lines, self._text = (self._text + data.decode("latin-1")).replace("\r", "\n").split("\n")
        self._text = self._text[-200:]
        return b"".join(self._obey(line) for line in lines)

    def tick(self) -> bytes:
        if self._plant.time >= self._until:
            self._plant.turn_wheels(0.0, 0.0)
            self._until = math.inf
        self._turn()
        return b""

    def _turn(self) -> None:
        if self._head:
            self._head.tick()

    def _obey(self, line: str) -> bytes:
        words = line.lower().split()
        if not words:
            return b""
        found = [each for each in COMMANDS if each.lower().startswith(words[0])]
        body = self._answer(found[0], words[1:]) if len(found) == 1 else f"Unknown Cmd: '{line}'\r\n"
        return f"{line}\r\n{body}".encode("latin-1") + b"\x1a"

    def _answer(self, command: str, words: list[str]) -> str:
        if command == "TestMode":
            self.test_mode = "on" in words
            if not self.test_mode:
                self._plant.turn_wheels(0.0, 0.0)
                self._turn_head(on=False)
        elif command in ("SetMotor", "SetLDSRotation") and not self.test_mode:
            return "TestMode must be on to use this command.\r\n"
        elif command == "SetLDSRotation":
            self._turn_head(on="on" in words)
        elif command == "SetMotor":
            return self._set_motor(dict(zip(words[::2], words[1::2], strict=False)))
        elif command == "GetMotors":
            left, right = (
                (int(each * 1000.0) + self._counted + 0x80000000) % 0x100000000 - 0x80000000
                for each in self._plant.rolled()
            )
            return f"Parameter,Value\r\nLeftWheel_PositionInMM,{left}\r\nRightWheel_PositionInMM,{right}\r\n"
        elif command == "GetLDSScan":
            return self._scan()
        elif command in ("GetDigitalSensors", "GetAnalogSensors", "GetCharger", "GetVersion"):
            return self._report(command)
        return ""

    def _report(self, command: str) -> str:
        if command == "GetDigitalSensors":
            on = self._plant.bumpers()
            rows = {"SNSR_DC_JACK_CONNECT": 0, "SNSR_DUSTBIN_IS_IN": 1, "SNSR_LEFT_WHEEL_EXTENDED": int(self.lifted),
                    "SNSR_RIGHT_WHEEL_EXTENDED": int(self.lifted), "LSIDEBIT": int(on.get("left_side", False)),
                    "LFRONTBIT": int(on.get("left_front", False)), "RSIDEBIT": int(on.get("right_side", False)),
                    "RFRONTBIT": int(on.get("right_front", False))}  # fmt: skip
            return "Digital Sensor Name, Value\r\n" + "".join(f"{name},{value}\r\n" for name, value in rows.items())
        if command == "GetAnalogSensors":
            deep = self._plant.cliffs()
            drops = {f"{side.title()}DropInMM": 250 if deep.get(side) else 60 for side in ("left", "right")}
            battery = f"BatteryVoltageInmV,{int(self._plant.battery()[0] * 1000)},\r\n"
            return "SensorName,Value\r\n" + battery + "".join(f"{name},{value},\r\n" for name, value in drops.items())
        if command == "GetCharger":
            volts, _, charge, capacity = self._plant.battery()
            fuel = round(100.0 * charge / capacity) if capacity else 0
            return f"Label,Value\r\nFuelPercent,{fuel}\r\nChargingActive,0\r\nVBattV,{volts:.2f}\r\nVExtV,0.00\r\n"
        return "Component,Major,Minor,Build\r\nModelID,-1,BotvacD85,\r\nSoftware,3,2,18119\r\n"

    def _set_motor(self, values: dict[str, str]) -> str:
        try:
            left, right = (int(values.get(f"{side}wheeldist", "0")) for side in "lr")
            speed = min(_FASTEST, int(values.get("speed", "0")))
        except ValueError:
            return "Invalid parameter\r\n"
        farthest = max(abs(left), abs(right))
        if not farthest or speed <= 0:
            return "Speed and distance must be set\r\n"
        self._plant.turn_wheels(*(speed * distance / farthest / 1000.0 for distance in (left, right)))
        self._until = self._plant.time + farthest / speed
        return ""

    def _turn_head(self, *, on: bool) -> None:
        if self._head:
            self._head.turns = on

    def _scan(self) -> str:
        head = self._head
        table = head.table if head and head.turns else np.zeros(360)
        rows = [f"{angle},{mm:.0f},{90 if mm else 0},{0 if mm else '8035'}" for angle, mm in enumerate(table)]
        rate = self._plant.base.lidar.rate if self._plant.base.lidar and head and head.turns else 0.0
        return "\r\n".join(["AngleInDegrees,DistInMM,Intensity,ErrorCodeHEX", *rows, f"ROTATION_SPEED,{rate:.2f}\r\n"])
