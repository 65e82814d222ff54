"""Robot bases: the file `bases/<base>/base.yaml`, read and checked.

The same file feeds the real robot, its URDF and the simulated one. Lengths are in m, masses in kg, angles in rad,
times in s, voltages in V, currents in A; poses are in `base_footprint` (REP 103 axes: x forward, y left, z up) unless
a field gives another unit.
"""

from ur.robot.base.files import list_bases, list_variants, load_base, read_base
from ur.robot.base.properties import BRAKE_AFTER, Base, Caster, MotionLimits, OdometryErrors, UpstreamDriver, Wheels
from ur.robot.base.sensors import (
    SENSORS,
    BatteryProperties,
    Bumper,
    Bumpers,
    Camera,
    Cliff,
    Cliffs,
    ImuErrors,
    Lidar,
    Sonar,
    Sonars,
)

__all__ = [
    "BRAKE_AFTER",
    "SENSORS",
    "Base",
    "BatteryProperties",
    "Bumper",
    "Bumpers",
    "Camera",
    "Caster",
    "Cliff",
    "Cliffs",
    "ImuErrors",
    "Lidar",
    "MotionLimits",
    "OdometryErrors",
    "Sonar",
    "Sonars",
    "UpstreamDriver",
    "Wheels",
    "list_bases",
    "list_variants",
    "load_base",
    "read_base",
]
