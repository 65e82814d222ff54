"""The parameters of the node `amcl`, under upstream's names (https://wiki.ros.org/amcl), checked."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.likelihood import BeamModel
from ur_nodes.localisation.localiser import FilterSettings
from ur_nodes.localisation.motion_model import MotionModel, OdometryKind
from ur_nodes.localisation.particle_filter import SampleSize
from ur_nodes.ports.parameters import Parameters

_LEAST_SAVED_SPREAD = (0.1, 0.1, 0.05)  # m, m, rad: the robot may have been moved a little while the node was down


@dataclass(frozen=True, slots=True, eq=False)
class AmclSettings:
    """The node's parameters. Rates are in Hz, 0 or less for none; `transform_tolerance` in s.

    `laser_limits` are -1 for the scan's own limits. `initial_covariance` is (3, 3) in m and rad.
    """

    filter: FilterSettings
    beams: BeamModel
    laser_limits: tuple[float, float]
    odom_frame: str
    base_frame: str
    map_frame: str
    tf_broadcast: bool
    transform_tolerance: float
    cloud_rate: float
    save_rate: float
    use_map_topic: bool
    first_map_only: bool
    initial_pose: Pose2
    initial_covariance: NDArray[np.float64]
    seed: int


def read_settings(parameters: Parameters) -> AmclSettings:
    """Read the settings of a node. Defaults are upstream's. Raises UserError, which names the parameter."""
    p = parameters
    p.text("laser_model_type", "likelihood_field", choices=("likelihood_field", "likelihood_field_prob"))
    variances = [p.number(f"initial_cov_{name}", value, minimum=0.0) for name, value in _INITIAL]
    pose = Pose2(*(p.number(f"initial_pose_{name}", 0.0) for name in ("x", "y", "a")))
    return AmclSettings(
        filter=_read_filter(p),
        beams=BeamModel(
            z_hit=p.number("laser_z_hit", 0.95, minimum=0.0),
            z_rand=p.number("laser_z_rand", 0.05, minimum=0.0),
            sigma_hit=p.number("laser_sigma_hit", 0.2, minimum=1e-3),
            max_distance=p.number("laser_likelihood_max_dist", 2.0, minimum=0.01),
        ),
        laser_limits=(
            p.number("laser_min_range", -1.0, live="least range of a scan that is used, m; -1: the scan's own"),
            p.number("laser_max_range", -1.0, live="greatest range of a scan that is used, m; -1: the scan's own"),
        ),
        odom_frame=_frame(p, "odom_frame_id", "odom"),
        base_frame=_frame(p, "base_frame_id", "base_link"),
        map_frame=_frame(p, "global_frame_id", "map"),
        tf_broadcast=p.boolean("tf_broadcast", True),
        transform_tolerance=p.number("transform_tolerance", 0.1, minimum=0.0),
        cloud_rate=p.number("gui_publish_rate", -1.0),
        save_rate=p.number("save_pose_rate", 0.5),
        use_map_topic=p.boolean("use_map_topic", False),
        first_map_only=p.boolean("first_map_only", False),
        initial_pose=pose,
        initial_covariance=np.diag(variances),
        seed=p.integer("seed", 0, minimum=0),
    )


def saved_parameters(pose: Pose2, covariance: NDArray[np.float64]) -> dict[str, float]:
    """Return the parameters with which a restarted node continues from this pose."""
    spread = [max(float(covariance[i, i]), least * least) for i, least in enumerate(_LEAST_SAVED_SPREAD)]
    values = {f"initial_pose_{name}": value for name, value in zip("xya", pose, strict=True)}
    return values | {f"initial_cov_{name}": value for (name, _), value in zip(_INITIAL, spread, strict=True)}


_INITIAL = (("xx", 0.25), ("yy", 0.25), ("aa", (math.pi / 12.0) ** 2))


def _read_filter(p: Parameters) -> FilterSettings:
    minimum = p.integer("min_particles", 100, minimum=1)
    kinds: tuple[OdometryKind, ...] = ("diff", "diff-corrected", "omni", "omni-corrected")
    wanted = p.text("odom_model_type", "diff", choices=kinds)
    alphas = [p.number(f"odom_alpha{number}", 0.2, minimum=0.0) for number in (1, 2, 3, 4, 5)]
    return FilterSettings(
        size=SampleSize(
            minimum=minimum,
            maximum=p.integer("max_particles", max(5000, minimum), minimum=minimum),
            kld_err=p.number("kld_err", 0.01, minimum=1e-4, maximum=1.0),
            kld_z=p.number("kld_z", 0.99, minimum=0.0, maximum=10.0),
        ),
        motion=MotionModel(next(kind for kind in kinds if kind == wanted), *alphas),
        max_beams=p.integer("laser_max_beams", 30, minimum=2, live="beams of a scan that are used"),
        update_min_d=p.number("update_min_d", 0.2, minimum=0.0, live="way between two updates, m"),
        update_min_a=p.number("update_min_a", math.pi / 6.0, minimum=0.0, live="turn between two updates, rad"),
        resample_interval=p.integer("resample_interval", 2, minimum=1, live="updates between two resamplings"),
        recovery_alpha_slow=p.number("recovery_alpha_slow", 0.0, minimum=0.0, maximum=1.0),
        recovery_alpha_fast=p.number("recovery_alpha_fast", 0.0, minimum=0.0, maximum=1.0),
        selective_resampling=p.boolean("selective_resampling", False, live="resample only when few particles count"),
        refine=p.boolean("refine", True, live="match the scan to the map"),
        notice_lost=p.boolean("notice_lost", True, live="search the whole map when scans no longer fit"),
    )


def _frame(p: Parameters, name: str, default: str) -> str:
    return p.text(name, default).lstrip("/")  # tf1 wrote frames with a slash; tf2 refuses it
