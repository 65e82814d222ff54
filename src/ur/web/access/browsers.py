"""A name for people of the device that a browser runs on."""

from __future__ import annotations

_NAMES = (
    ("iphone", "iPhone"),
    ("ipad", "iPad"),
    ("cros", "Chromebook"),
    ("android", "Android"),
    ("windows", "Windows"),
    ("macintosh", "Mac"),
    ("linux", "Linux"),
)


def name_device(user_agent: str | None) -> str:
    """The device that a User-Agent header names; `a browser` where it names none."""
    text = (user_agent or "")[:1000].lower()
    return next((name for mark, name in _NAMES if mark in text), "a browser")
