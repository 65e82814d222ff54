"""A Neato robot's USB console, from the tables of the "Neato Programmer's Manual" (2014) and its worked answers.

Commands are matched by as many letters as make them unique, without regard to case, as the manual says.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from ur_nodes.simulator.devices.lidars import TurningHead
from ur_nodes.simulator.devices.plant import Plant

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

    def take(self, data: bytes) -> bytes:
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

    def take(self, data: bytes) -> bytes:
        *lines, self._text = (self._text + data.decode("latin-1")).replace("\r", "\n").split("\n")
        self._text = self._text[-200:]
        return b"".join(self._obey(line) for line in lines)

    def tick(self) -> bytes:
        if self._plant.time >= self._until:
            self._plant.turn_wheels(0.0, 0.0)
            self._until = math.inf
        if self._head:
            self._head.tick()
        return b""

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
        self._plant.turn_wheels(*(speed * way / farthest / 1000.0 for way in (left, right)))
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
