"""A driver of an inertial unit: its readings to messages, at the rate of the base file."""

from collections.abc import Callable

from ur.robot.base import ImuErrors
from ur_nodes.drivers.health import HealthMeter, Report
from ur_nodes.drivers.imus.imu import I2cBus, InertialDevice, InertialReading, UnitIdentity
from ur_nodes.drivers.lines.line import REPORT, PolledDevice, PolledUser, explain_error
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Imu

_ORIENTATION_VARIANCE = 0.0025  # rad^2, about 3 degrees: the BNO055's data sheet gives none for this mode
_UNKNOWN = -1.0  # of an orientation that is not measured, as sensor_msgs/Imu says
_SILENT = 3.0  # s without a reading, after which it is reported
_HELP = "is it wired, is I2C on (dtparam=i2c_arm=on), and is this user in its group (i2c or dialout)?"


class ImuDriver:
    """Reads the unit, publishes what makes sense, and sets it up again after it was away."""

    def __init__(
        self,
        node: Node,
        imu: ImuErrors,
        unit: InertialDevice,
        device: tuple[str, Callable[[], I2cBus | str]],
        report: Report = lambda _: None,
    ) -> None:
        """`device` is the file of its bus and what opens it; `report` gets its health."""
        self._node, self._imu, self._unit, self._name = node, imu, unit, device[0]
        self._readings = node.publish(imu.topic, Imu)
        self._known: UnitIdentity | None = None
        self._read = node.steady()
        self._health = HealthMeter(node, self._name, unit.name, report)
        self._device = PolledDevice(node, *device, PolledUser(self._handshake, self._lost))
        node.every(1.0 / imu.rate, self._beat, steady=True)

    def _handshake(self) -> None:
        self._known = None
        self._read = self._node.steady()
        self._device.ask(self._begin, self._on_identity)

    def _lost(self, reason: str) -> None:
        self._known = None
        self._health.note(open=False, reason=reason)
        self._node.log.error(f"{self._name}: {reason}; expected a {self._unit.name}; {_HELP} It is tried again")

    def _begin(self, bus: I2cBus) -> UnitIdentity | str:
        try:
            return self._unit.begin(bus)
        except OSError as problem:
            return explain_error(problem)

    def _on_identity(self, identity: UnitIdentity, _: int) -> None:
        self._known = identity
        self._health.note(open=True, reason="", problem=identity.problem, firmware=identity.text)
        if identity.problem:
            self._node.log.error(f"{self._name}: {self._unit.name}: {identity.problem}", every=REPORT)
        else:
            self._node.log.info(f"{self._name}: {self._unit.name}: {identity.text}")

    def _beat(self) -> None:
        if self._known is None:
            return
        silent = self._node.steady() - self._read > _SILENT
        if not self._known.problem:
            self._device.ask(self._ask, self._on_answer)
            if silent:
                text = f"{self._unit.name} gives no sound reading; does the robot rest, and are the wires short?"
                self._node.log.warn(f"{self._name}: {text}", every=REPORT)
        elif silent:
            self._handshake()  # perhaps it is the right one by now

    def _ask(self, bus: I2cBus) -> tuple[InertialReading | None, int] | str:
        begun = self._node.now()
        try:
            return self._unit.read(bus), begun
        except OSError as problem:
            return explain_error(problem)

    def _on_answer(self, answer: tuple[InertialReading | None, int], now: int) -> None:
        reading, begun = answer
        self._health.count(int(reading is not None), int(reading is None))
        if reading is None:
            return
        self._read = self._node.steady()
        orientation = reading.orientation or (0.0, 0.0, 0.0, 1.0)
        variance = _ORIENTATION_VARIANCE if reading.orientation else _UNKNOWN
        noises = self._imu.gyro_noise**2, self._imu.accel_noise**2
        measured = orientation, reading.turning, reading.force
        self._readings.send(Imu((begun + now) // 2, self._imu.frame, *measured, variance, *noises))
