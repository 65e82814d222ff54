"""A Hokuyo lidar, by the wiki pages of the URG network on the commands of SCIP and the answers of a Classic-URG.

It sees all round, with a step a degree, and gives as its parameters what the base file says of the lidar.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ur_nodes.simulator.devices.lidars import TurningHead
from ur_nodes.simulator.devices.plant import Plant

STEPS = 360
FRONT = 180


class HokuyoFirmware(TurningHead):
    """See Firmware."""

    clockwise = False

    def __init__(self, plant: Plant) -> None:
        super().__init__(plant)
        self._line = ""
        self._scan = ""
        self._distances: list[float] = []

    def take(self, data: bytes) -> bytes:
        *lines, self._line = (self._line + data.decode("latin-1")).split("\n")
        self._line = self._line[-40:]
        return b"".join(self._obey(line) for line in lines if line)

    def pack(self, beams: npt.NDArray[np.int64], millimetres: npt.NDArray[np.float64]) -> bytes:
        """See TurningHead: a block at the end of each turn."""
        sent = b""
        for beam, distance in zip(beams.tolist(), millimetres.tolist(), strict=True):
            step = (beam + FRONT) % STEPS
            if step == 0:
                self._distances = []
            self._distances.append(distance)
            if step == STEPS - 1 and len(self._distances) == STEPS and self._scan:
                sent += self._send_scan()
        return sent

    def _send_scan(self) -> bytes:
        clock = int(self._plant.time * 1000.0) % (1 << 24)
        characters = "".join(_encode(min(round(each), 65535), 3) for each in self._distances)
        rows = [_encode(clock, 4), *(characters[at : at + 64] for at in range(0, len(characters), 64))]
        body = "".join(f"{row}{_sum(row)}\n" for row in rows)
        return f"{self._scan}\n99b\n{body}\n".encode("latin-1")

    def _obey(self, line: str) -> bytes:
        lidar = self._lidar
        if line == "VV":
            rows = ["VEND:Hokuyo Automatic Co.,Ltd.", "PROD:stand-in", "FIRM:1.0", "PROT:SCIP 2.0", "SERI:H1"]
        elif line == "PP":
            near, far = round(lidar.range_min * 1000), round(lidar.range_max * 1000)
            rows = ["MODL:stand-in", f"DMIN:{near}", f"DMAX:{far}", f"ARES:{STEPS}", "AMIN:0", f"AMAX:{STEPS - 1}",
                    f"AFRT:{FRONT}", f"SCAN:{round(lidar.rate * 60)}"]  # fmt: skip
        elif line.startswith("MD"):
            if line[2:10] != f"0000{STEPS - 1:04d}":
                return f"{line}\n05U\n\n".encode("latin-1")
            self._scan, self._distances = line, []
            return f"{line}\n00P\n\n".encode("latin-1")
        elif line in ("QT", "SCIP2.0"):
            self._scan = "" if line == "QT" else self._scan
            return f"{line}\n00P\n\n".encode("latin-1")
        else:
            return f"{line}\n0Ee\n\n".encode("latin-1")
        return f"{line}\n00P\n{''.join(f'{row};{_sum(row)}{chr(10)}' for row in rows)}\n".encode("latin-1")


def _encode(value: int, characters: int) -> str:
    return "".join(chr((value >> 6 * place) % 64 + 48) for place in reversed(range(characters)))


def _sum(text: str) -> str:
    return chr(sum(map(ord, text)) % 64 + 48)
