"""Message types that are not installed, as ROS 2's middleware needs them: a name and a hash; messages are CDR bytes.

A type of Fast DDS is described by a table of functions that read and write C structures. Those who send and receive
bytes never call them: the table of an installed type serves, under another name. Jazzy makes no endpoint without a
description of the fields, either, and compares none: that of the installed type serves, too. Structures:
rosidl_runtime_c `message_type_support_struct.h`, rosidl_typesupport_fastrtps_cpp `message_type_support.h` (Kilted).
"""

import ctypes
from functools import cache
from importlib.util import find_spec
from typing import Any

from rclpy.utilities import get_rmw_implementation_identifier

_HANDLE = b"rosidl_message_type_support_t"
_TABLES, _FIELDS = "rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"
_FAST_DDS_2 = "libfastrtps.so"


class _TypeHash(ctypes.Structure):
    _fields_ = (("version", ctypes.c_uint8), ("value", ctypes.c_uint8 * 32))


_GetHash = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)
_GetPart = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)


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
    ctypes.CDLL("librcutils.so").rcutils_reset_error()


@cache
def bare_class(package: str, name: str, hash: str) -> Any:
    """Make a message class for rclpy, `raw` on both ends.

    `hash` is RIHS01 in hex, of 32 bytes. Raises OSError if the middleware of this computer has no such tables.
    """
    if find_spec("rclpy.type_hash") is None:
        raise OSError("types of Humble have no hash, and tables of another layout")
    donor = _find_donor(_TABLES)
    callbacks = _Callbacks.from_buffer_copy(ctypes.cast(donor.data, ctypes.POINTER(_Callbacks)).contents)
    callbacks.namespace, callbacks.name = f"{package}::msg".encode(), name.encode()
    number = _TypeHash(1, (ctypes.c_uint8 * 32)(*bytes.fromhex(hash)))
    support = _TypeSupport.from_buffer_copy(donor)
    support.data = ctypes.cast(ctypes.pointer(callbacks), ctypes.c_void_p)
    support.get_type_hash = _GetHash(lambda _support: ctypes.addressof(number))
    part = _get_part() if _needs_fields() else None
    if part is not None:
        support.func = ctypes.cast(part, ctypes.c_void_p)  # type: ignore[arg-type]  # a function of C
    make = ctypes.pythonapi.PyCapsule_New
    make.restype, make.argtypes = ctypes.py_object, (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
    from sensor_msgs.msg import PointCloud2

    PointCloud2.__class__.__import_type_support__()  # type: ignore[attr-defined]  # of rclpy's metaclass
    names = ("_CREATE_ROS_MESSAGE", "_CONVERT_FROM_PY", "_CONVERT_TO_PY", "_DESTROY_ROS_MESSAGE")
    parts = {each: getattr(PointCloud2, each) for each in names}
    parts |= {"_TYPE_SUPPORT": make(ctypes.addressof(support), _HANDLE, None)}
    return type(f"{name}Type", (type,), parts)(name, (), {"tables": (callbacks, support, number, part)})


def _find_donor(kind: str) -> _TypeSupport:
    """Return the table of the installed type. Raises OSError if it is missing."""
    find = ctypes.CDLL(f"libsensor_msgs__{kind}.so")[
        f"{kind}__get_message_type_support_handle__sensor_msgs__msg__PointCloud2"
    ]
    find.restype = ctypes.POINTER(_TypeSupport)
    found: _TypeSupport = find().contents
    return found


def _needs_fields() -> bool:
    """Return whether the middleware is Fast DDS 2."""
    if not get_rmw_implementation_identifier().startswith("rmw_fastrtps"):
        return False
    try:
        ctypes.CDLL(_FAST_DDS_2)
    except OSError:
        return False
    return True


def _get_part() -> object:
    """Return the function of a table that finds the one of another kind for the same type."""
    fields = ctypes.addressof(_find_donor(_FIELDS))
    known = {_TABLES.encode(): None, _FIELDS.encode(): fields}
    return _GetPart(lambda own, kind: (known[kind] or own) if kind in known else None)
