"""Made by tools/make_message_stubs.py. Do not edit."""

from collections.abc import MutableSequence, Sequence
import genpy
import geometry_msgs.msg
import std_msgs.msg

class BatteryState(genpy.Message):
    POWER_SUPPLY_STATUS_UNKNOWN: int
    POWER_SUPPLY_STATUS_CHARGING: int
    POWER_SUPPLY_STATUS_DISCHARGING: int
    POWER_SUPPLY_STATUS_NOT_CHARGING: int
    POWER_SUPPLY_STATUS_FULL: int
    POWER_SUPPLY_HEALTH_UNKNOWN: int
    POWER_SUPPLY_HEALTH_GOOD: int
    POWER_SUPPLY_HEALTH_OVERHEAT: int
    POWER_SUPPLY_HEALTH_DEAD: int
    POWER_SUPPLY_HEALTH_OVERVOLTAGE: int
    POWER_SUPPLY_HEALTH_UNSPEC_FAILURE: int
    POWER_SUPPLY_HEALTH_COLD: int
    POWER_SUPPLY_HEALTH_WATCHDOG_TIMER_EXPIRE: int
    POWER_SUPPLY_HEALTH_SAFETY_TIMER_EXPIRE: int
    POWER_SUPPLY_TECHNOLOGY_UNKNOWN: int
    POWER_SUPPLY_TECHNOLOGY_NIMH: int
    POWER_SUPPLY_TECHNOLOGY_LION: int
    POWER_SUPPLY_TECHNOLOGY_LIPO: int
    POWER_SUPPLY_TECHNOLOGY_LIFE: int
    POWER_SUPPLY_TECHNOLOGY_NICD: int
    POWER_SUPPLY_TECHNOLOGY_LIMN: int
    POWER_SUPPLY_TECHNOLOGY_TERNARY: int
    POWER_SUPPLY_TECHNOLOGY_VRLA: int
    header: std_msgs.msg.Header
    voltage: float
    temperature: float
    current: float
    charge: float
    capacity: float
    design_capacity: float
    percentage: float
    power_supply_status: int
    power_supply_health: int
    power_supply_technology: int
    present: bool
    cell_voltage: Sequence[float]
    cell_temperature: Sequence[float]
    location: str
    serial_number: str
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        voltage: float = ...,
        temperature: float = ...,
        current: float = ...,
        charge: float = ...,
        capacity: float = ...,
        design_capacity: float = ...,
        percentage: float = ...,
        power_supply_status: int = ...,
        power_supply_health: int = ...,
        power_supply_technology: int = ...,
        present: bool = ...,
        cell_voltage: Sequence[float] = ...,
        cell_temperature: Sequence[float] = ...,
        location: str = ...,
        serial_number: str = ...,
    ) -> None: ...

class CameraInfo(genpy.Message):
    header: std_msgs.msg.Header
    height: int
    width: int
    distortion_model: str
    D: Sequence[float]
    K: MutableSequence[float]
    R: MutableSequence[float]
    P: MutableSequence[float]
    binning_x: int
    binning_y: int
    roi: RegionOfInterest
    d: Sequence[float]
    k: MutableSequence[float]
    r: MutableSequence[float]
    p: MutableSequence[float]
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        height: int = ...,
        width: int = ...,
        distortion_model: str = ...,
        D: Sequence[float] = ...,
        K: MutableSequence[float] = ...,
        R: MutableSequence[float] = ...,
        P: MutableSequence[float] = ...,
        binning_x: int = ...,
        binning_y: int = ...,
        roi: RegionOfInterest = ...,
        d: Sequence[float] = ...,
        k: MutableSequence[float] = ...,
        r: MutableSequence[float] = ...,
        p: MutableSequence[float] = ...,
    ) -> None: ...

class CompressedImage(genpy.Message):
    header: std_msgs.msg.Header
    format: str
    data: bytes
    def __init__(self, header: std_msgs.msg.Header = ..., format: str = ..., data: bytes = ...) -> None: ...

class Image(genpy.Message):
    header: std_msgs.msg.Header
    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    data: bytes
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        height: int = ...,
        width: int = ...,
        encoding: str = ...,
        is_bigendian: int = ...,
        step: int = ...,
        data: bytes = ...,
    ) -> None: ...

class Imu(genpy.Message):
    header: std_msgs.msg.Header
    orientation: geometry_msgs.msg.Quaternion
    orientation_covariance: MutableSequence[float]
    angular_velocity: geometry_msgs.msg.Vector3
    angular_velocity_covariance: MutableSequence[float]
    linear_acceleration: geometry_msgs.msg.Vector3
    linear_acceleration_covariance: MutableSequence[float]
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        orientation: geometry_msgs.msg.Quaternion = ...,
        orientation_covariance: MutableSequence[float] = ...,
        angular_velocity: geometry_msgs.msg.Vector3 = ...,
        angular_velocity_covariance: MutableSequence[float] = ...,
        linear_acceleration: geometry_msgs.msg.Vector3 = ...,
        linear_acceleration_covariance: MutableSequence[float] = ...,
    ) -> None: ...

class JointState(genpy.Message):
    header: std_msgs.msg.Header
    name: Sequence[str]
    position: Sequence[float]
    velocity: Sequence[float]
    effort: Sequence[float]
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        name: Sequence[str] = ...,
        position: Sequence[float] = ...,
        velocity: Sequence[float] = ...,
        effort: Sequence[float] = ...,
    ) -> None: ...

class Joy(genpy.Message):
    header: std_msgs.msg.Header
    axes: Sequence[float]
    buttons: Sequence[int]
    def __init__(
        self, header: std_msgs.msg.Header = ..., axes: Sequence[float] = ..., buttons: Sequence[int] = ...
    ) -> None: ...

class LaserScan(genpy.Message):
    header: std_msgs.msg.Header
    angle_min: float
    angle_max: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    ranges: Sequence[float]
    intensities: Sequence[float]
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        angle_min: float = ...,
        angle_max: float = ...,
        angle_increment: float = ...,
        time_increment: float = ...,
        scan_time: float = ...,
        range_min: float = ...,
        range_max: float = ...,
        ranges: Sequence[float] = ...,
        intensities: Sequence[float] = ...,
    ) -> None: ...

class PointCloud2(genpy.Message):
    header: std_msgs.msg.Header
    height: int
    width: int
    fields: list[PointField]
    is_bigendian: bool
    point_step: int
    row_step: int
    data: bytes
    is_dense: bool
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        height: int = ...,
        width: int = ...,
        fields: list[PointField] = ...,
        is_bigendian: bool = ...,
        point_step: int = ...,
        row_step: int = ...,
        data: bytes = ...,
        is_dense: bool = ...,
    ) -> None: ...

class PointField(genpy.Message):
    INT8: int
    UINT8: int
    INT16: int
    UINT16: int
    INT32: int
    UINT32: int
    FLOAT32: int
    FLOAT64: int
    name: str
    offset: int
    datatype: int
    count: int
    def __init__(self, name: str = ..., offset: int = ..., datatype: int = ..., count: int = ...) -> None: ...

class Range(genpy.Message):
    ULTRASOUND: int
    INFRARED: int
    header: std_msgs.msg.Header
    radiation_type: int
    field_of_view: float
    min_range: float
    max_range: float
    range: float
    variance: float
    def __init__(
        self,
        header: std_msgs.msg.Header = ...,
        radiation_type: int = ...,
        field_of_view: float = ...,
        min_range: float = ...,
        max_range: float = ...,
        range: float = ...,
        variance: float = ...,
    ) -> None: ...

class RegionOfInterest(genpy.Message):
    x_offset: int
    y_offset: int
    height: int
    width: int
    do_rectify: bool
    def __init__(
        self, x_offset: int = ..., y_offset: int = ..., height: int = ..., width: int = ..., do_rectify: bool = ...
    ) -> None: ...
