"""Drivers of a new base, chosen by the names of this project's drivers: lines of base.yaml, and a launch file."""

from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean
from ur.tools.new.parts import NewFile

_HEAD = """\
<launch>
  <!--Summary: Bring up the drivers of a real {name}.-->
  <!--Overview: They are part of ubiquity_launches: {what}.-->

  <!-- Optional arguments -->
  <arg name="robot_variant" default=""/>
  <!--robot_variant: The variant of the base; empty for the plain base.-->
  <arg name="robot_machine" default="localhost"/>
  <!--robot_machine: The robot: where these nodes run.-->
  <arg name="device_folder" default="/dev"/>
  <!--device_folder: The folder of the devices; another than `/dev` for the stand-ins of `simulate:=devices`.-->

"""
_INCLUDE = """\
  <include file="$(find ubiquity_launches)/{node}/launch/{node}.launch.xml">
    <arg name="robot_base" value="{name}"/>
    <arg name="robot_variant" value="$(arg robot_variant)"/>
    <arg name="package" value="$(find {package})/bases/{name}/../.."/>
    <arg name="device_folder" value="$(arg device_folder)"/>
    <arg name="machine" value="$(arg robot_machine)"/>
  </include>
"""


def check_driver(option: str, name: str | None, sensor: str) -> None:
    """Raise UserError for a name that is not a driver of a base (`sensor` '') or of that sensor."""
    known = [each for each, driver in OWN_DRIVERS.items() if driver.sensor == sensor]
    if name is None or name in known:
        return
    near = did_you_mean(name, known)
    message = f"unknown driver '{name}' for {option}, expected one of {', '.join(known)}"
    help_ = f"did you mean {near}?" if near else "leave it out, and add `driver` to base.yaml by hand"
    raise UserError(error(message, rule="unknown-driver", help=help_, subject=name))


def refuse_sideways(driver: str | None, aside: float | None) -> None:
    """Raise UserError for a driver with a base that drives sideways: its board drives two wheels."""
    if driver and aside:
        message = f"--driver {driver} drives two wheels, expected no --lateral-velocity"
        help_ = "leave out --driver, and name the driver of your mecanum or omni base in its base.yaml"
        raise UserError(error(message, rule="bad-value", help=help_))


def driver_speeds(driver: str | None) -> dict[str, float]:
    """Return the highest speeds of a base with a driver, by the names of its figures; empty where it knows none."""
    fastest = OWN_DRIVERS[driver].fastest if driver else None
    return dict(zip(("velocity", "angular_velocity"), fastest, strict=True)) if fastest else {}


def driver_lines(driver: str | None, lidar: str | None) -> str:
    """Return the lines of base.yaml that name the drivers."""
    lines = f"driver: {driver} # {OWN_DRIVERS[driver].what}, at {OWN_DRIVERS[driver].device}\n" if driver else ""
    return lines + (f"drivers: {{lidar: {lidar}}} # at {OWN_DRIVERS[lidar].device}\n" if lidar else "")


def driver_files(name: str, package: str, driver: str | None, lidar: str | None) -> list[NewFile]:
    """Return the launch file that starts the drivers of base `name` of a package; empty without a driver."""
    used = [each for each in (driver, lidar) if each]
    if not driver:
        return []
    head = _HEAD.format(name=name, what=", ".join(OWN_DRIVERS[each].what for each in used))
    parts = [_INCLUDE.format(node=OWN_DRIVERS[each].node, name=name, package=package) for each in used]
    folder = f"m_{name}_drivers"
    return [NewFile(f"{folder}/launch/{folder}.launch.xml", f"{head}{''.join(parts)}</launch>\n")]
