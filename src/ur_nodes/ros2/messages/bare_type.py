"""Message types that are not installed, as ROS 2's middleware needs them: a name and a hash; messages are CDR bytes.

A type of Fast DDS is described by a table of functions that read and write C structures. Those who send and receive
bytes never call them: the table of an installed type serves, under another name. Structures: rosidl_runtime_c
`message_type_support_struct.h`, rosidl_typesupport_fastrtps_cpp `message_type_support.h` (Kilted).
"""

from __future__ import annotations

import ctypes
from functools import cache
from importlib.util import find_spec
from typing import Any

from sensor_msgs.msg import PointCloud2

_HANDLE = b"rosidl_message_type_support_t"
_SYMBOL = "rosidl_typesupport_fastrtps_c__get_message_type_support_handle__sensor_msgs__msg__PointCloud2"
_LIBRARY = "libsensor_msgs__rosidl_typesupport_fastrtps_c.so"


class _TypeHash(ctypes.Structure):
    _fields_ = (("version", ctypes.c_uint8), ("value", ctypes.c_uint8 * 32))


_GetHash = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)


class _TypeSupport(ctypes.Structure):
    _fields_ = (
        ("identifier", ctypes.c_char_p),
        ("data", ctypes.c_void_p),
        ("func", ctypes.c_void_p),
        ("get_type_hash", _GetHash),
        ("get_description", ctypes.c_void_p),
        ("get_sources", ctypes.c_void_p),
    )


class _Callbacks(ctypes.Structure):
    _fields_ = (
        ("namespace", ctypes.c_char_p),
        ("name", ctypes.c_char_p),
        ("serialize", ctypes.c_void_p),
        ("deserialize", ctypes.c_void_p),
        ("serialized_size", ctypes.c_void_p),
        ("max_serialized_size", ctypes.c_void_p),
        ("key_callbacks", ctypes.c_void_p),
    )


def reset_error() -> None:
    """Clear the error that the middleware sets on this thread for a bare type, whose fields it does not find.

    The next failure would report both.
    """
    _load_utilities().rcutils_reset_error()


@cache
def _load_utilities() -> ctypes.CDLL:
    return ctypes.CDLL("librcutils.so")


@cache
def bare_class(package: str, name: str, hash: str) -> Any:
    """Make a message class for rclpy, `raw` on both ends.

    `hash` is RIHS01 in hex, of 32 bytes. Raises OSError if the middleware of this computer has no such tables.
    """
    if find_spec("rclpy.type_hash") is None:
        raise OSError("types of Humble have no hash, and tables of another layout")
    find = ctypes.CDLL(_LIBRARY)[_SYMBOL]
    find.restype = ctypes.POINTER(_TypeSupport)
    donor: _TypeSupport = find().contents
    callbacks = _Callbacks.from_buffer_copy(ctypes.cast(donor.data, ctypes.POINTER(_Callbacks)).contents)
    callbacks.namespace, callbacks.name = f"{package}::msg".encode(), name.encode()
    number = _TypeHash(1, (ctypes.c_uint8 * 32)(*bytes.fromhex(hash)))
    support = _TypeSupport.from_buffer_copy(donor)
    support.data = ctypes.cast(ctypes.pointer(callbacks), ctypes.c_void_p)
    support.get_type_hash = _GetHash(lambda _support: ctypes.addressof(number))
    make = ctypes.pythonapi.PyCapsule_New
    make.restype, make.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
    PointCloud2.__class__.__import_type_support__()  # type: ignore[attr-defined]  # of rclpy's metaclass
    names = ("_CREATE_ROS_MESSAGE", "_CONVERT_FROM_PY", "_CONVERT_TO_PY", "_DESTROY_ROS_MESSAGE")
    parts = {each: getattr(PointCloud2, each) for each in names}
    parts |= {"_TYPE_SUPPORT": make(ctypes.addressof(support), _HANDLE, None)}
    return type(f"{name}Type", (type,), parts)(name, (), {"tables": (callbacks, support, number)})
