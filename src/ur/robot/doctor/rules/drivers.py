"""Rules about the drivers and muxes that run on a computer: devices, motors, batteries, commands, calibration."""

from collections.abc import Iterator

from ur.devices.driver_health import (
    OBSERVE_DRIVERS,
    DriverHealth,
    MotionRecord,
    RefusedCommands,
    describe_errors,
    parse_drivers,
    parse_records,
)
from ur.robot.base.own_drivers import NO_WATCHDOG
from ur.robot.doctor.findings import Finding, Where
from ur.robot.doctor.rules.registry import Rule, SideRule
from ur.robot.doctor.side import Side

DAMAGED = 0.02  # the share of damaged frames, above which something is wrong with the line
_FEW = 0.5  # damaged frames a second that mean nothing


def read_drivers(side: Side) -> tuple[DriverHealth, ...]:
    """The drivers of a computer that run."""
    return parse_drivers(side.observed.get("drivers", ""))


def describe_driver(driver: DriverHealth) -> str:
    """Describe a driver in a line: device, kind, firmware, frames, battery, how it stops, no watchdog."""
    rates = (
        f"{driver.frames:.0f} frames/s, {driver.damaged:.1f} damaged" if driver.open else f"not open: {driver.reason}"
    )
    parts = [f"{driver.device}: {driver.kind}", driver.firmware, rates]
    parts += [f"{driver.voltage:.1f} V" if driver.voltage else "", driver.stops]
    parts += [NO_WATCHDOG if driver.drives_on else ""]
    return ", ".join(part for part in parts if part)


def check_drivers(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check what the drivers report; one finding a driver, the first cause."""
    for driver in read_drivers(side):
        name = f"{side.name}: {driver.device}: {driver.kind}"
        if not driver.open:
            yield Finding("driver-without-device", f"{name}: {driver.reason or 'not open yet'}", _PLUG)
        elif driver.problem:
            yield Finding("driver-refuses", f"{name} cannot be used: {driver.problem}", "the log says it, too: ur logs")
        elif driver.frames <= 0.0:
            help_ = "is it switched on, and is this its device? Stop the programs, then: ur devices"
            yield Finding("driver-silent", f"{name} sends nothing that its driver understands", help_)
        elif driver.damaged > _FEW and driver.damaged > DAMAGED * (driver.frames + driver.damaged):
            share = driver.damaged / (driver.frames + driver.damaged)
            help_ = "a shorter or shielded cable, away from the motors' wires; is the speed of its line right?"
            yield Finding("damaged-frames", f"{name}: {share:.0%} of its frames arrive damaged", help_)
        elif driver.held:
            yield Finding("motors-held", f"{name} does not drive: {driver.held}", "set that right; it drives by itself")
        if driver.open and driver.empty:
            yield Finding("empty-battery", f"{name}: its battery is empty ({driver.voltage:.1f} V)", "charge it")


def check_commands(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check for programs whose velocity commands the mux refuses."""
    for refused in parse_records(side.observed.get("drivers", ""), RefusedCommands):
        yield Finding("refused-commands", f"{side.name}: {refused.text}", refused.help)


def check_calibration(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check whether lidar and wheels are as described, by what the robot has driven."""
    for record in parse_records(side.observed.get("drivers", ""), MotionRecord):
        if text := describe_errors(record):
            yield Finding("not-calibrated", f"{side.name}: {text}", f"ur robot calibrate {side.name}")


_PLUG = "plug it in; what is there: ur devices. It is opened again by itself"
RULES: tuple[Rule, ...] = (
    SideRule(
        {
            "driver-without-device": "a driver cannot open its device",
            "driver-refuses": "a driver cannot use its device, as one with an old firmware",
            "driver-silent": "a device sends nothing that its driver understands",
            "damaged-frames": "a device's frames arrive damaged",
            "motors-held": "the motors of a board do not obey, as while the emergency stop is pressed",
            "empty-battery": "the battery of a board is empty",
        },
        check_drivers,
        observe={"drivers": OBSERVE_DRIVERS},
    ),
    SideRule(
        {"refused-commands": "the mux refuses the velocity commands of a program, as at a rate below 10 Hz"},
        check_commands,
        simulation=True,
        observe={"drivers": OBSERVE_DRIVERS},
    ),
    SideRule(
        {"not-calibrated": "the lidar or the wheels differ from their description, as driving shows"},
        check_calibration,
        simulation=True,
        observe={"drivers": OBSERVE_DRIVERS},
    ),
)
