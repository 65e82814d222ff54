"""Settings of the simulator node."""

from dataclasses import dataclass, replace

from ur.robot.base import Camera
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.simulator.simulation import Simulation


@dataclass(frozen=True, slots=True)
class FrameNames:
    """Names of frames, without a robot's prefix."""

    map: str
    odom: str
    base: str


@dataclass(frozen=True, slots=True)
class SimulatorSettings:
    """`speed` is simulated seconds per second, 0 as fast as possible; `step_period` what one ~step advances by, s."""

    speed: float
    publish_clock: bool
    clock_rate: float
    joint_rate: float
    step_period: float
    frames: FrameNames

    @property
    def quality(self) -> Quality:
        """At full speed the simulation waits for its subscribers, and nothing is lost."""
        return Quality.LOSSLESS if self.speed == 0.0 else Quality.EVERY


def read_settings(own: Parameters, *, simulated_clock: bool) -> SimulatorSettings:
    """The settings; `simulated_clock`: nodes go by /clock. Raises UserError: a parameter is not what is expected."""
    speed = own.number("speed", 1.0, minimum=0.0)
    return SimulatorSettings(
        speed=speed,
        publish_clock=own.boolean("publish_clock", simulated_clock) or speed != 1.0,
        clock_rate=own.number("clock_rate", 50.0, minimum=1.0, maximum=1000.0),
        joint_rate=own.number("joint_rate", 10.0, minimum=0.1, maximum=1000.0),
        step_period=own.number("step_period", 0.1, minimum=0.001, maximum=60.0),
        frames=FrameNames(
            own.text("map_frame", "map"), own.text("odom_frame", "odom"), own.text("base_frame", "base_footprint")
        ),
    )


def read_camera(own: Parameters, camera: Camera) -> tuple[Camera, int]:
    """The base's camera with the size and rate that are asked for (0: the base's own), and the quality of JPEGs."""
    width, height = own.integer("camera_width", 0, minimum=0), own.integer("camera_height", 0, minimum=0)
    rate = own.number("camera_rate", 0.0, minimum=0.0, maximum=200.0)
    quality = min(own.integer("jpeg_quality", 80, minimum=1), 95)
    return replace(
        camera, width=width or camera.width, height=height or camera.height, rate=rate or camera.rate
    ), quality


def list_prefixes(simulation: Simulation) -> list[str]:
    """Return the prefix of the topics and frames of each robot: '' where there is only one."""
    return [f"robot_{n}/" if simulation.robots > 1 else "" for n in range(simulation.robots)]
