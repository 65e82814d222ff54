"""Values about a camera's pictures, and the Protocol of their sources."""

from dataclasses import dataclass
from typing import Protocol

from ur_nodes.pictures.decode import Pixels


class CameraError(Exception):
    """A camera cannot be used now. `reason` names the thing and what is wrong, `help` what to do ('' for nothing).

    `waits`: nothing was plugged in or it is in use, so that it is worth trying again; a wrong setting is not.
    """

    def __init__(self, reason: str, help: str = "", *, waits: bool = True) -> None:
        super().__init__(f"{reason}; {help}" if help else reason)
        self.reason, self.help, self.waits = reason, help, waits


@dataclass(frozen=True, slots=True)
class Adjustments:
    """Adjustments of the picture, on the scales of raspicam_node; None leaves the camera as it is.

    `brightness` from 0 to 100; `contrast`, `saturation` and `sharpness` from -100 to 100; `shutter_speed` in
    microseconds, 0 for automatic exposure.
    """

    brightness: int | None = None
    contrast: int | None = None
    saturation: int | None = None
    sharpness: int | None = None
    shutter_speed: int | None = None


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """Requested pictures: size in pixels, rate in pictures a second, JPEG quality from 1 to 100, mirroring."""

    width: int = 640
    height: int = 480
    rate: float = 30.0
    quality: int = 80
    flip_horizontally: bool = False
    flip_vertically: bool = False
    adjustments: Adjustments = Adjustments()


@dataclass(frozen=True, slots=True)
class Mode:
    """The mode of a camera's pictures. `format` is its pixel format; `rate` is 0.0 if unknown.

    `passed_on`: its JPEG pictures are published unchanged; others are encoded here. `missing` are the requested
    settings that it has no control for.
    """

    camera: str
    path: str
    width: int
    height: int
    rate: float
    format: str
    passed_on: bool
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Frame:
    """One picture: its age in s when it was read, and JPEG data or pixels, as the camera delivers them."""

    age: float
    jpeg: bytes = b""
    pixels: Pixels | None = None


class PictureSource(Protocol):
    """An open camera that takes pictures."""

    @property
    def mode(self) -> Mode:
        """Return the mode of its pictures."""

    def read(self, seconds: float, *, wanted: bool = True) -> Frame | None:
        """Return the newest picture; None if none arrived within that time.

        With `wanted` False a picture is read from the camera and returned empty. Raises CameraError when the camera
        was unplugged or has failed.
        """

    def close(self) -> None:
        """Release the camera. May be called twice."""
