"""Values that are one word or number, and lines of the log."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from rosgraph_msgs.msg import Clock
from std_msgs.msg import Bool, Empty, Float32, Float64, Int32, String

from ur_nodes.codecs.codec import Codec, KindCodec
from ur_nodes.codecs.dialect import ROS_2, LogMessage, TimeMessage, stamp_of, time_of
from ur_nodes.ports.values import ClockTime, Level, LogLine, Number, Signal, Time

Value = TypeVar("Value")


def _data(message_class: type[Any], kind: Callable[[Any], Value]) -> KindCodec[Value]:
    def fill(message: Any, value: Value) -> None:
        message.data = value

    return Codec(message_class, fill, lambda message: kind(message.data))


def _fill_number(message: Float64, value: Number) -> None:
    message.data = value.value


def _fill_clock(message: Clock, value: ClockTime) -> None:
    message.clock = time_of(value.stamp)


def _fill_time(message: TimeMessage, value: Time) -> None:
    if ROS_2 and not TYPE_CHECKING:
        message.sec, message.nanosec = divmod(value.stamp, 1_000_000_000)
    else:
        message.data = time_of(value.stamp)


def _time_of(message: TimeMessage) -> Time:
    if ROS_2 and not TYPE_CHECKING:
        return Time(stamp_of(message))
    return Time(stamp_of(message.data))


def _fill_line(message: LogMessage, value: LogLine) -> None:
    message.name, message.level, message.msg = value.node, _LEVELS[value.level], value.text


def _line_of(message: LogMessage) -> LogLine:
    level: Level = next((name for name in _LEVELS if message.level >= _LEVELS[name]), "debug")
    return LogLine(message.name, level, message.msg)


_LEVELS: dict[Level, int] = (
    {"error": 40, "warn": 30, "info": 20, "debug": 10} if ROS_2 else {"error": 8, "warn": 4, "info": 2, "debug": 1}
)

CODECS = {
    str: _data(String, str),
    bool: _data(Bool, bool),
    float: _data(Float32, float),
    int: _data(Int32, int),
    LogLine: Codec(LogMessage, _fill_line, _line_of),
    Number: Codec(Float64, _fill_number, lambda message: Number(message.data)),
    Signal: Codec(Empty, lambda _message, _value: None, lambda _message: Signal()),
    Time: Codec(TimeMessage, _fill_time, _time_of),
    ClockTime: Codec(Clock, _fill_clock, lambda message: ClockTime(stamp_of(message.clock))),
}
