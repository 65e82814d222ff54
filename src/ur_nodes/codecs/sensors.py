"""Scans, sonars, inertia and batteries."""

import numpy as np
from sensor_msgs.msg import BatteryState
from sensor_msgs.msg import Imu as ImuMessage
from sensor_msgs.msg import Range as RangeMessage

from ur_nodes.codecs.codec import Codec, fill_header, frame_of
from ur_nodes.codecs.dialect import ScanMessage, array_of, field_of, stamp_of
from ur_nodes.ports.values import Battery, Imu, Range, Scan

# Of sensor_msgs/BatteryState, which knows no lead.
_TECHNOLOGIES = {"nimh": 1, "lithium-ion": 2, "lithium-polymer": 3, "lifepo4": 4, "nicd": 5}
_TECHNOLOGY_OF = {number: name for name, number in _TECHNOLOGIES.items()}


def _fill_scan(message: ScanMessage, value: Scan) -> None:
    fill_header(message, value.stamp, value.frame)
    last = value.angle_min + (len(value.ranges) - 1) * value.angle_increment
    message.angle_min, message.angle_increment = value.angle_min, value.angle_increment
    message.angle_max = last if value.angle_max is None else value.angle_max
    message.range_min, message.range_max, message.scan_time = value.range_min, value.range_max, value.scan_time
    message.ranges, message.intensities = field_of(value.ranges), field_of(value.intensities)
    message.time_increment = value.time_increment


def _scan_of(message: ScanMessage) -> Scan:
    return Scan(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.angle_min,
        message.angle_increment,
        message.range_min,
        message.range_max,
        array_of(message.ranges, np.float32),
        array_of(message.intensities, np.float32),
        message.scan_time,
        message.angle_max,
        message.time_increment,
    )


def _fill_range(message: RangeMessage, value: Range) -> None:
    fill_header(message, value.stamp, value.frame)
    message.radiation_type = RangeMessage.INFRARED if value.infrared else RangeMessage.ULTRASOUND
    message.range, message.field_of_view = value.range, value.field_of_view
    message.min_range, message.max_range = value.range_min, value.range_max


def _range_of(message: RangeMessage) -> Range:
    return Range(
        stamp_of(message.header.stamp),
        frame_of(message),
        message.range,
        message.field_of_view,
        message.min_range,
        message.max_range,
        message.radiation_type == RangeMessage.INFRARED,
    )


def _fill_imu(message: ImuMessage, value: Imu) -> None:
    fill_header(message, value.stamp, value.frame)
    q, turning, force = message.orientation, message.angular_velocity, message.linear_acceleration
    q.x, q.y, q.z, q.w = value.orientation
    turning.x, turning.y, turning.z = value.turning
    force.x, force.y, force.z = value.force
    message.orientation_covariance = _diagonal(value.orientation_variance)
    message.angular_velocity_covariance = _diagonal(value.turning_variance)
    message.linear_acceleration_covariance = _diagonal(value.force_variance)


def _imu_of(message: ImuMessage) -> Imu:
    q, turning, force = message.orientation, message.angular_velocity, message.linear_acceleration
    return Imu(
        stamp_of(message.header.stamp),
        frame_of(message),
        (q.x, q.y, q.z, q.w),
        (turning.x, turning.y, turning.z),
        (force.x, force.y, force.z),
        message.orientation_covariance[0],
        message.angular_velocity_covariance[0],
        message.linear_acceleration_covariance[0],
    )


def _diagonal(variance: float) -> list[float]:
    return [variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance]


def _fill_battery(message: BatteryState, value: Battery) -> None:
    fill_header(message, value.stamp, "")
    message.voltage, message.current, message.charge = value.voltage, value.current, value.charge
    message.capacity = message.design_capacity = value.capacity
    message.percentage, message.temperature, message.present = value.fraction, float("nan"), True
    charging, discharging = BatteryState.POWER_SUPPLY_STATUS_CHARGING, BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
    message.power_supply_status = charging if value.charging else discharging
    message.power_supply_health = BatteryState.POWER_SUPPLY_HEALTH_GOOD
    message.power_supply_technology = _TECHNOLOGIES.get(value.technology, 0)


def _battery_of(message: BatteryState) -> Battery:
    return Battery(
        stamp_of(message.header.stamp),
        message.voltage,
        message.current,
        message.charge,
        message.capacity,
        message.percentage,
        message.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_CHARGING,
        _TECHNOLOGY_OF.get(message.power_supply_technology, ""),
    )


CODECS = {
    Scan: Codec(ScanMessage, _fill_scan, _scan_of),
    Range: Codec(RangeMessage, _fill_range, _range_of),
    Imu: Codec(ImuMessage, _fill_imu, _imu_of),
    Battery: Codec(BatteryState, _fill_battery, _battery_of),
}
