"""The parameters of `move_base`, under upstream's names, checked. Those that are `live` may be set while it runs."""

from dataclasses import dataclass

from ur_nodes.costmap.costmap import Inflation
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.costmap.layers import UsedRanges
from ur_nodes.costmap.local_costmap_settings import read_footprint
from ur_nodes.costmap.touched import BumperSource, read_bumpers
from ur_nodes.navigation.navigator_step import NavigatorSettings
from ur_nodes.navigation.planning.global_plan import PlanSettings
from ur_nodes.navigation.steering.speed_profile import SpeedLimits
from ur_nodes.ports.parameters import Parameters

_SONARS = UsedRanges(1.2, 1.2)


@dataclass(frozen=True, slots=True)
class ScanSource:
    """One laser for obstacles; after `silence` s without a scan the robot stops."""

    topic: str
    reach: UsedRanges
    inf_is_valid: bool
    silence: float


@dataclass(frozen=True, slots=True)
class CostmapSettings:
    """One costmap: its frame, its publish rate (Hz, 0: only on changes), inflation, scan.

    Without a scan the walls are those of the map, and other obstacles those of the sonars: `sonars` are their topics.
    """

    frame: str
    publish_frequency: float
    inflation: Inflation
    scan: ScanSource | None
    sonars: tuple[str, ...] = ()

    @property
    def reach(self) -> UsedRanges:
        """The ranges of the scan that are used, or of the sonars without one."""
        return self.scan.reach if self.scan else _SONARS


@dataclass(frozen=True, slots=True)
class MoveBaseSettings:
    """All parameters of `move_base`, except those of `AttendanceSettings`.

    A command is sent `repeats` times a control period, with the mux's challenge if `stamped`. A goal that has ended is
    in the status list for `status_kept` seconds, so that a client that was cut off learns how it ended. The topics of
    masks of zones may be empty.
    """

    base_frame: str
    tolerance: float
    footprint: Footprint
    world: CostmapSettings
    local: CostmapSettings
    local_side: float
    local_resolution: float
    lethal: int
    track_unknown: bool
    bumpers: tuple[BumperSource, ...]
    imu_topic: str
    map_topic: str
    keep_out_topic: str
    speed_topic: str
    reset_distance: float
    mux: str
    repeats: int
    stamped: bool
    status_kept: float
    navigator: NavigatorSettings
    planner: PlanSettings
    limits: SpeedLimits


def read_settings(top: Parameters) -> MoveBaseSettings:
    """Read the settings from the node's parameters. Raises UserError, which names the parameter."""
    world, local = top.below("global_costmap"), top.below("local_costmap")
    resolution = local.number("resolution", 0.05, minimum=0.005, maximum=1.0)
    footprint = read_footprint(local if local.has("footprint") or local.has("robot_radius") else world, resolution)
    static = world.below("static_layer")
    navigator = _navigator(top)
    commands = top.number("command_frequency", 30.0, minimum=0.0, maximum=100.0)
    return MoveBaseSettings(
        base_frame=world.text("robot_base_frame", "base_footprint"),
        tolerance=local.number("transform_tolerance", 0.5, minimum=0.05),
        footprint=footprint,
        world=_costmap(world, "map", footprint),
        local=_costmap(local, "odom", footprint),
        local_side=max(local.number("width", 4.0, minimum=1.0), local.number("height", 4.0, minimum=1.0)),
        local_resolution=resolution,
        lethal=static.integer("lethal_cost_threshold", 65, minimum=1),
        track_unknown=static.boolean("track_unknown_space", world.boolean("track_unknown_space", True)),
        bumpers=read_bumpers(local.below("bumper_layer")),
        imu_topic=top.text("imu_topic", "imu/data"),
        map_topic=static.text("map_topic", "map"),
        keep_out_topic=world.below("keepout_filter").text("mask_topic", "keepout_filter_mask"),
        speed_topic=world.below("speed_filter").text("mask_topic", "speed_filter_mask"),
        reset_distance=top.number("conservative_reset_dist", 3.0, minimum=0.0),
        mux=top.text("mux", "cmd_vel_mux"),
        repeats=max(1, round(commands * navigator.period)),
        stamped=top.boolean("stamped_commands", True),
        status_kept=top.number("status_list_timeout", 600.0, minimum=0.0, maximum=86400.0),
        navigator=navigator,
        planner=_planner(top, footprint, resolution),
        limits=_limits(top.below("DWAPlannerROS"), top.below("TebLocalPlannerROS")),
    )


def _costmap(part: Parameters, frame: str, footprint: Footprint) -> CostmapSettings:
    slopes = part.below("inflation_layer")
    radius = part.number("inflation_radius", 0.55, minimum=0.0)
    scaling = part.number("cost_scaling_factor", 10.0, minimum=0.1)
    inflation = Inflation(
        footprint.inscribed,
        slopes.number("inflation_radius", radius, minimum=0.0, live="distance up to which obstacles add costs, m"),
        slopes.number("cost_scaling_factor", scaling, minimum=0.1, live="decrease of costs with distance, 1/m"),
    )
    return CostmapSettings(
        part.text("global_frame", frame),
        part.number("publish_frequency", 1.0, minimum=0.0),
        inflation,
        _scan(part.below("obstacle_layer")),
        part.below("sonar_layer").texts("topics", ()),
    )


def _scan(obstacles: Parameters) -> ScanSource | None:
    names = obstacles.text("observation_sources", "scan").split()
    if not names:
        return None
    if len(names) > 1:
        obstacles.fail("observation_sources", " ".join(names), "one name at most: this node looks at one laser")
    source = obstacles.below(names[0])
    source.text("data_type", "LaserScan", choices=["LaserScan"])
    reach = UsedRanges(
        source.number("obstacle_range", obstacles.number("obstacle_range", 2.5, minimum=0.1), minimum=0.1),
        source.number("raytrace_range", obstacles.number("raytrace_range", 3.0, minimum=0.1), minimum=0.1),
    )
    return ScanSource(
        topic=source.text("topic", names[0]),
        reach=reach,
        inf_is_valid=source.boolean("inf_is_valid", False),
        silence=source.number("expected_update_rate", 0.0, minimum=0.0) or 1.0,
    )


def _navigator(top: Parameters) -> NavigatorSettings:
    dwa = top.below("DWAPlannerROS")
    planner_frequency = top.number("planner_frequency", 0.0, minimum=0.0, live="plans, Hz; 0: when one is needed")
    return NavigatorSettings(
        period=1.0 / top.number("controller_frequency", 10.0, minimum=4.0, maximum=100.0),
        xy_tolerance=dwa.number("xy_goal_tolerance", 0.1, minimum=0.02, live="accepted distance from the goal, m"),
        yaw_tolerance=dwa.number("yaw_goal_tolerance", 0.05, minimum=0.01, live="accepted error of the heading, rad"),
        planner_period=1.0 / planner_frequency if planner_frequency > 0.0 else 0.0,
        planner_patience=top.number("planner_patience", 5.0, minimum=0.1, live="s without a plan until a recovery"),
        controller_patience=top.number("controller_patience", 5.0, minimum=0.1, live="s blocked until a recovery"),
        people_patience=top.number("people_patience", 30.0, minimum=1.0, live="s that people may be in the way"),
        recovery_enabled=top.boolean("recovery_behavior_enabled", True, live="try recoveries before a goal fails"),
        progress_timeout=top.number("oscillation_timeout", 10.0, minimum=0.0, live="s at rest until a recovery")
        or 10.0,
        progress_distance=top.number(
            "oscillation_distance", 0.5, minimum=0.05, live="m until recoveries are forgotten"
        ),
    )


def _planner(top: Parameters, footprint: Footprint, resolution: float) -> PlanSettings:
    navfn, weights = top.below("NavfnROS"), top.below("GlobalPlanner")
    return PlanSettings(
        neutral=weights.number("neutral_cost", 50.0, minimum=1.0, live="cost of a free cell for planning"),
        factor=weights.number("cost_factor", 0.3, minimum=0.0, live="weight of the costs round obstacles for planning"),
        allow_unknown=navfn.boolean("allow_unknown", True, live="plan through unknown space"),
        tolerance=navfn.number("default_tolerance", 0.0, minimum=0.0, live="distance of a path's end from the goal, m"),
        nudge=0.5 * top.below("DWAPlannerROS").number("xy_goal_tolerance", 0.1, minimum=0.02),
        room=footprint.circumscribed + resolution,
    )


def _limits(dwa: Parameters, teb: Parameters) -> SpeedLimits:
    return SpeedLimits(
        speed=dwa.limit("max_vel_x", 0.5, minimum=0.01, live="greatest speed ahead, m/s"),
        turn=dwa.limit("max_vel_theta", 1.0, minimum=0.01, live="greatest turn, rad/s"),
        acceleration=dwa.number("acc_lim_x", 1.0, minimum=0.01),
        turn_acceleration=dwa.number("acc_lim_theta", 3.0, minimum=0.01),
        lateral=dwa.limit("max_vel_y", 0.0, minimum=0.0, live="greatest speed to the side, m/s"),
        radius=teb.number("min_turning_radius", 0.0, minimum=0.0, maximum=20.0),
    )
