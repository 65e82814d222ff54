"""Pictures of the simulated world, drawn by a separate process so that physics never waits for them.

`CameraProcess` is the client; run as a module, this file is the process that draws. They communicate through the pipes
of the process: it is given one JSON line (the model, the textures to draw, the size, the quality), answers one line
("ok" or what is wrong), and then turns requests (robot, what is wanted, the length of the state, the state) into
answers (the lengths of pixels and JPEG, and those). It ends when its input does, so it cannot outlive its caller.
"""

from __future__ import annotations

import contextlib
import io
import os
import struct
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import IO, BinaryIO

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base, Camera
from ur.source.diagnostic import Diagnostic, UserError, error, user_error
from ur.source.foreign.json_values import read_json, write_json
from ur.worlds.world_file import Fiducial, WorldModel
from ur_nodes.memory_use import return_code
from ur_nodes.simulator.mujoco_model import build_model
from ur_nodes.simulator.scenery import build_scenery, draw_textures

_REQUEST = struct.Struct("<iiiq")  # robot, pixels wanted, JPEG wanted, bytes of state
_ANSWER = struct.Struct("<qq")
_LONGEST_JOB = 64 << 20  # bytes
_BACKENDS = ("egl", "osmesa")  # how MuJoCo can draw without a screen, the quicker to start first
_ABSENT = "not installed"
_SETTLED = 100  # pictures, after which Mesa has compiled what they need; the first one needs nearly all of it
_INSTALL = "sudo apt-get install libegl1 libopengl0 libgl1-mesa-dri"


@dataclass(frozen=True, slots=True)
class RenderedPicture:
    """One picture: RGB rows from the top (bytes) and a JPEG file; either is empty if not requested."""

    pixels: bytes
    jpeg: bytes


@dataclass(frozen=True, slots=True)
class CameraJob:
    """The first line to the process: the model as MJCF, its fiducials, and the requested pictures."""

    model: str
    fiducials: tuple[Fiducial, ...]
    width: int
    height: int
    quality: int


class CameraProcess:
    """Renders the cameras of robots of one base. Not for two threads at once."""

    def __init__(
        self,
        world: WorldModel,
        base: Base,
        camera: Camera,
        robots: int,
        *,
        quality: int = 80,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        """`camera` is the base's with the requested size. Raises UserError without a working renderer."""
        fiducials, self.warning = _drawable(world.fiducials)
        scenery = build_scenery(camera, fiducials, robots)
        model = build_model(world, base, robots, world.start, scenery)
        job = CameraJob(model, fiducials, camera.width, camera.height, quality)
        chosen = environment.get("MUJOCO_GL", "off")
        reasons: dict[str, str] = {}
        for backend in _BACKENDS if chosen in ("", "off") else (chosen,):
            self._process = _start(backend, environment)
            answer = self._begin(write_json(job).encode() + b"\n")
            if answer == "ok":
                return
            self.close()
            reasons[backend] = answer
        raise UserError(_explain(reasons))

    @property
    def pid(self) -> int:
        """The process id of the renderer."""
        return self._process.pid

    def render(self, robot: int, state: npt.NDArray[np.float64], *, pixels: bool, jpeg: bool) -> RenderedPicture:
        """Render a robot's camera picture in a state (`Physics.state`). Raises UserError when the process has ended."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(_REQUEST.pack(robot, pixels, jpeg, state.nbytes) + state.tobytes())
            self._process.stdin.flush()
            sizes = _ANSWER.unpack(_read(self._process.stdout, _ANSWER.size))
            return RenderedPicture(*(_read(self._process.stdout, size) for size in sizes))
        except (OSError, ValueError, EOFError):
            message = "the simulated camera's process has ended, expected pictures"
            raise user_error(message, rule="no-renderer") from None

    def kill(self) -> None:
        """End the process while a picture is drawn on another thread, whose `take` fails then."""
        self._process.kill()

    def close(self) -> None:
        """End the process."""
        for stream in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):  # what was not yet written is of no use any more
                if stream:
                    stream.close()
        try:
            self._process.wait(timeout=2.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _begin(self, job: bytes) -> str:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(job)
            self._process.stdin.flush()
            answer = self._process.stdout.readline().decode(errors="replace").strip()
        except OSError:
            answer = ""
        return answer or "it ended at once"


def _explain(reasons: Mapping[str, str]) -> Diagnostic:
    """Return the failures of all renderers as one error."""
    if set(reasons.values()) == {_ABSENT}:
        message = "the simulated camera cannot draw: OpenGL is not installed"
    else:
        each = "; ".join(f"{backend}: {reason}" for backend, reason in reasons.items())
        message = f"the simulated camera cannot draw ({each}), expected OpenGL without a screen"
    return error(message, rule="no-renderer", help=_INSTALL)


def _drawable(fiducials: tuple[Fiducial, ...]) -> tuple[tuple[Fiducial, ...], str]:
    """Return the fiducials that can be drawn, and a message about the others."""
    from importlib.util import find_spec

    if not fiducials or find_spec("cv2"):
        return fiducials, ""
    return (), (
        f"the {len(fiducials)} fiducials of this world are not drawn: OpenCV is not installed;"
        " 'ur run fiducial_slam' installs it"
    )


def _start(backend: str, environment: Mapping[str, str]) -> subprocess.Popen[bytes]:
    # A session of its own: Ctrl-C in a terminal ends the simulator, and that ends this one.
    return subprocess.Popen(
        [sys.executable, "-I", "-m", __name__],
        env={**environment, "MUJOCO_GL": backend},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def _read(stream: IO[bytes], size: int) -> bytes:
    data: bytes = stream.read(size)
    if len(data) < size:
        raise EOFError
    return data


def serve(requests: BinaryIO, answers: BinaryIO) -> int:
    """Draw the requested pictures until the input ends."""
    os.nice(5)  # physics first
    from multiprocessing import get_context

    job = read_json(requests.readline(), CameraJob, _LONGEST_JOB)
    renderer: mujoco.Renderer | None = None
    try:
        with get_context("fork").Pool(1) as other:  # OpenCV's memory ends with it
            textures = other.apply(draw_textures, (job.fiducials,))
        try:
            import mujoco
        except (AttributeError, ImportError):  # PyOpenGL's, where the library that it wraps is missing
            raise RuntimeError(_ABSENT) from None

        from ur_nodes.simulator.physics import restore_state

        model = mujoco.MjModel.from_xml_string(job.model, textures)
        data = mujoco.MjData(model)
        renderer = mujoco.Renderer(model, job.height, job.width, model.ngeom + 50)
        renderer.render()
    except Exception as problem:  # all exceptions of drivers and libraries are passed to the node
        answers.write((str(problem).replace("\n", " ") or type(problem).__name__).encode()[:300] + b"\n")
        answers.flush()
        return 1
    answers.write(b"ok\n")
    answers.flush()
    drawn = 0
    try:
        while True:
            robot, pixels, jpeg, size = _REQUEST.unpack(_read(requests, _REQUEST.size))
            restore_state(model, data, np.frombuffer(_read(requests, size)))
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            renderer.update_scene(data, f"camera_{robot}")
            image = renderer.render()
            raw = image.tobytes() if pixels else b""
            packed = pack_jpeg(image, job.quality) if jpeg else b""
            answers.write(_ANSWER.pack(len(raw), len(packed)) + raw + packed)
            answers.flush()
            if drawn % _SETTLED == 0:
                return_code("libLLVM")
            drawn += 1
    except (EOFError, OSError):
        return 0
    finally:
        renderer.close()


def pack_jpeg(image: npt.NDArray[np.uint8], quality: int) -> bytes:
    """Encode an RGB image (height, width, 3) as a JPEG file."""
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(image).save(file, "JPEG", quality=quality)
    return file.getvalue()


if __name__ == "__main__":
    sys.exit(serve(sys.stdin.buffer, sys.stdout.buffer))
