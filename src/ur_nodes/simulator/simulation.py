"""The whole simulation in lock step: robots, their controllers, encoders and lidars, on one schedule of time steps."""

import math

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base
from ur.source.diagnostic import user_error
from ur.source.suggest import did_you_mean
from ur.worlds.world_file import WorldModel
from ur_nodes.geometry.hull import hull_of_outline
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.ramp import WheelDrive
from ur_nodes.simulator.mujoco_model import TIME_STEP, build_model, start_pose
from ur_nodes.simulator.people.pedestrians import NearbyRobot, Pedestrians
from ur_nodes.simulator.people.strike import Strikes
from ur_nodes.simulator.physics import Physics
from ur_nodes.simulator.schedule import Schedule, SimulationTick
from ur_nodes.simulator.senses import Senses
from ur_nodes.simulator.sensors.flat_rays import make_lidars
from ur_nodes.simulator.sensors.odometry import EncoderOdometry

CONTROL_RATE = 50.0  # Hz
COLLISION_PAUSE = 0.5  # s
_PLACED = frozenset(("odometry", "scan"))  # they come with the robot's place


class Simulation:
    """Robots of one base in a world. The same seed and the same calls give the same results to the last bit."""

    def __init__(
        self,
        world: WorldModel,
        base: Base,
        *,
        robots: int = 1,
        seed: int = 0,
        start: tuple[float, float, float] | None = None,
        charge: float = 1.0,
        believed: Base | None = None,
    ) -> None:
        """`charge` is how full batteries are at first, 0 to 1; robots are `believed` to be of another base.

        Their odometry and their wheels' speeds are computed from that. Raises UserError when a robot would begin in a
        wall.
        """
        self.base, self.believed = base, believed or base
        self.robots = robots
        self._world = world
        self._seed = seed
        self._starts = [start_pose(base, number, start or world.start) for number in range(robots)]
        self._hull = hull_of_outline(base.footprint)
        self._physics = Physics(
            build_model(world, base, robots, start or world.start), robots, sideways=base.limits.sideways
        )
        self._lidars = make_lidars(self._physics.model, base.lidar, robots) if base.lidar else []
        self._steps_before = 0
        self._step: int = 0
        self._taken: set[int] = set()  # robots whose wheels have another controller
        self._noise: list[npt.NDArray[np.float64]] = []
        self._schedules: dict[str, Schedule] = {}
        self._picture_rate = 0.0
        seeds = np.random.SeedSequence(seed).spawn(3 * robots)[2 * robots :]
        self.senses = [Senses(base, self._physics, robot, own, charge, world.drops) for robot, own in enumerate(seeds)]
        self._begin()
        for robot in range(robots):
            pose = self._physics.pose(robot)
            _refuse(f"robot_{robot}", pose, self._outside(pose) or self._physics.blocked(robot))

    @property
    def time(self) -> float:
        """Simulated time since the start, s. It never goes back."""
        return (self._steps_before + self._step) * TIME_STEP

    @property
    def next_time(self) -> float:
        """The time that the next `advance` goes on to, s."""
        return (self._steps_before + self._next_step()) * TIME_STEP

    @property
    def collisions(self) -> tuple[int, ...]:
        """The number of collisions of each robot since the start or the last reset."""
        return tuple(self._collisions)

    @property
    def strikes(self) -> tuple[int, ...]:
        """Those of them in which the robot ran into a person, by its own motion."""
        return self._strikes.counts

    @property
    def has_people(self) -> bool:
        """Return whether people walk in the world."""
        return self._crowd is not None

    @property
    def people(self) -> npt.NDArray[np.float64]:
        """The poses (n, 3) of the people in the map."""
        if self._crowd is None:
            return np.empty((0, 3))
        return np.column_stack((self._crowd.places, self._crowd.headings))

    def command(self, robot: int, linear: float, angular: float, left: float = 0.0) -> None:
        """A velocity command that arrives now: m/s, rad/s. It takes effect with the next control period."""
        self._drives[robot].command(linear, angular, self.time, left)

    def control_wheels(self, robot: int) -> None:
        """From now on `turn_wheels` moves a robot, and `command` does not."""
        self._taken.add(robot)

    def turn_wheels(self, robot: int, left: float, right: float) -> None:
        """Set the speeds (rad/s) of the wheels of a robot whose wheels were taken."""
        self._physics.set_wheel_speeds(robot, left, right)

    def advance(self) -> SimulationTick:
        """Go on to the next moment at which something is due: a control period, or what the base publishes."""
        due = self._next_step()
        self._physics.step(due - self._step)
        self._step = due
        self._notice_touch()
        now = [name for name, schedule in self._schedules.items() if due >= schedule.step and schedule.consume(due)]
        placed = not self._placed.isdisjoint(now)
        if placed:
            self._read_encoders()
        if "scan" in now:
            self._noise = [random.standard_normal(self._noise[0].size) for random in self._random]
        if sensed := [name for name in now if name in self._sensed]:
            for senses in self.senses:
                senses.sample(sensed, self._step * TIME_STEP)
        if "control" in now:
            for robot, drive in enumerate(self._drives):
                if robot in self._taken:
                    continue
                self._turn_wheels(robot, *drive.update(self.time))
            self._move_people(1.0 / CONTROL_RATE)
        return SimulationTick(self.time, frozenset(now), placed)

    def enable_pictures(self, rate: float) -> None:
        """Make a picture due `rate` times a second from now on; 0: never."""
        self._picture_rate = rate
        self._schedules.pop("picture", None)
        if rate > 0.0:
            self._schedules["picture"] = Schedule(rate, self._step)

    def state(self) -> npt.NDArray[np.float64]:
        """A copy of where everything is, for the process that draws it; see `physics.restore_state`."""
        return self._physics.state()

    def odometry(self, robot: int) -> EncoderOdometry:
        """Return a robot's odometry: as of the last tick with odometry, a scan or sonars."""
        return self._odometry[robot]

    def scan(self, robot: int) -> npt.NDArray[np.float64]:
        """The ranges that a robot's lidar sees (m); see LidarBeams.cast. For bases that have a lidar."""
        return self._lidars[robot].cast(self._physics.data, self._noise[robot])

    def cast(self, robot: int, first: float, step: float, count: int) -> npt.NDArray[np.float64]:
        """Distances (m) from a robot's lidar now along `count` beams, from an angle (rad) on, a step (rad) apart."""
        return self._lidars[robot].cast_some(self._physics.data, first, step, count)

    def measured(self, robot: int, distances: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """The ranges (m) that a robot's lidar measures for distances (m), with the noise of the newest scan."""
        return self._lidars[robot].measured(distances, self._noise[robot])

    def pose(self, robot: int) -> Pose2:
        """Return a robot's true pose in the map."""
        return self._physics.pose(robot)

    def velocity(self, robot: int) -> tuple[float, float, float]:
        """Return a robot's true velocity: forward, to the left (m/s), yaw rate (rad/s)."""
        return self._physics.velocity(robot)

    def wheel_angles(self, robot: int) -> tuple[float, float]:
        """Return the angles of the left and the right wheel, rad."""
        return self._physics.wheel_angles(robot)

    def wheel_speeds(self, robot: int) -> tuple[float, float]:
        """Return the speeds of the left and the right wheel, rad/s."""
        return self._physics.wheel_speeds(robot)

    def reset(self) -> None:
        """Everything back to where it was at the start, noise included; time goes on."""
        self._steps_before += self._step
        self._physics.reset()
        self._begin()

    def set_pose(self, name: str, pose: tuple[float, float, float]) -> None:
        """Put a robot (`robot` or `robot_<n>`) or an obstacle somewhere, at rest. Odometry does not notice.

        Raises UserError, and moves nothing, when the name is not known or the pose is blocked.
        """
        names = [f"robot_{n}" for n in range(self.robots)] + [box.name for box in self._world.obstacles]
        name = "robot_0" if name in ("", "robot") else name
        if name not in names:
            near = did_you_mean(name, names)
            raise user_error(
                f"{name!r} cannot be placed, expected one of {', '.join(names)}",
                rule="unknown-name",
                help=f"did you mean {near!r}?" if near else None,
            )
        if not all(math.isfinite(value) for value in pose):
            raise user_error(f"{name}: a pose of {pose}, expected finite numbers", rule="bad-pose")
        if name.startswith("robot_"):
            robot = int(name[6:])
            blocked = self._outside(pose) or self._physics.move_robot(robot, pose)
            if not blocked:
                self._drives[robot] = WheelDrive(self.believed, 1.0 / CONTROL_RATE)
                self._turn_wheels(robot, 0.0, 0.0)
                self.senses[robot].forget_motion()
        else:
            blocked = self._physics.move_obstacle(name, pose)
        _refuse(name, pose, blocked)

    def _next_step(self) -> int:
        return min([schedule.step for schedule in self._schedules.values()])

    def _outside(self, pose: tuple[float, float, float]) -> str | None:
        return "outside the floor plan" if self._world.floor_plan.wall_at(pose[0], pose[1]) is None else None

    def _begin(self) -> None:
        base = self.base
        self._step = 0
        rates = {
            "control": CONTROL_RATE,
            "odometry": base.odometry.rate,
            "scan": base.lidar.rate if base.lidar else 0.0,
        }
        self._drives = [WheelDrive(self.believed, 1.0 / CONTROL_RATE) for _ in range(self.robots)]
        seeds = np.random.SeedSequence(self._seed).spawn(3 * self.robots)
        randoms = [np.random.Generator(np.random.PCG64(seed)) for seed in seeds[: 2 * self.robots]]
        self._odometry: list[EncoderOdometry] = [EncoderOdometry(self.believed, random) for random in randoms[::2]]
        self._random: list[np.random.Generator] = randoms[1::2]
        self._noise = [np.zeros(base.lidar.samples if base.lidar else 0) for _ in range(self.robots)]
        for senses in self.senses:
            senses.begin()
        own = self.senses[0].each if self.senses else {}
        self._sensed = frozenset(own)
        rates |= {name: sense.rate for name, sense in own.items()}
        self._placed = _PLACED | {name for name, sense in own.items() if sense.placed}
        self._schedules = {name: Schedule(rate) for name, rate in rates.items() if rate > 0.0}
        self.enable_pictures(self._picture_rate)
        self._crowd = Pedestrians(self._world, self._seed, self._starts) if self._world.people else None
        self._strikes = Strikes(self.robots)
        self._move_people(0.0)
        self._touched = [-math.inf] * self.robots
        self._collisions = [0] * self.robots
        self._read_encoders()

    def _read_encoders(self) -> None:
        for robot, odometry in enumerate(self._odometry):
            angles, aside = self._physics.wheel_angles(robot), self._physics.rolled_aside(robot)
            odometry.update(*angles, self.time, aside)

    def _turn_wheels(self, robot: int, left: float, right: float) -> None:
        self._physics.set_wheel_speeds(robot, left, right)
        if self.base.limits.sideways:
            drive = self._drives[robot]
            self._physics.set_velocity(robot, drive.velocity[0], drive.aside, drive.velocity[1])

    def _move_people(self, seconds: float) -> None:
        if self._crowd is None:
            return
        if self._crowd.is_due(self._step * TIME_STEP):
            sideways = self.base.limits.sideways
            velocities = [self._physics.velocity(robot) for robot in range(self.robots)]
            robots = [
                NearbyRobot(self._hull, self._physics.pose(robot), forward, turn, left if sideways else 0.0)
                for robot, (forward, left, turn) in enumerate(velocities)
            ]
            self._crowd.decide(self._step * TIME_STEP, robots)
        self._crowd.advance(seconds)
        self._physics.move_people(self._crowd.places, self._crowd.headings)

    def _notice_touch(self) -> None:
        """Contacts flicker: one that comes back soon is the same collision."""
        for robot in self._physics.touching:
            if self._crowd is not None:
                touched = [self._crowd.places[person] for person in self._physics.touched_people(robot)]
                self._strikes.notice(robot, self.pose(robot), self.velocity(robot), touched, self.time)
            self.senses[robot].feel_touch(self.time)
            if self.time - self._touched[robot] > COLLISION_PAUSE:
                self._collisions[robot] += 1
            self._touched[robot] = self.time


def _refuse(name: str, pose: tuple[float, float, float], blocked: str | None) -> None:
    """Raise UserError if the pose is blocked."""
    if blocked:
        place = f"x {pose[0]:g}, y {pose[1]:g}"
        raise user_error(f"{name} cannot be at {place}: {blocked}, expected free floor", rule="not-free")
