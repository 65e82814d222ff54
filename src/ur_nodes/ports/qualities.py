"""Qualities of service of topics.

A topic is LATCHED at publisher and subscriber, or keeps nothing: on ROS 2 a subscriber of another quality misses the
value that was sent before it subscribed, and a LATCHED subscriber receives nothing of a publisher that is not LATCHED.
A topic that third-party nodes may publish with either has two subscribers, one of each quality. Raw subscriptions use
the quality of the publisher.
"""

from enum import Enum


class Quality(Enum):
    """The quality of service of a topic, equal at publisher and subscriber."""

    NEWEST = "newest"
    """Only the newest counts: one that is still waiting is replaced."""

    LATCHED = "latched"
    """As NEWEST, and a LATCHED subscriber that listens later gets the last one that was sent."""

    LATCHED_EVERY = "latched every"
    """For a subscriber to what is LATCHED: each counts, in order, also the last ones of several publishers."""

    EVERY = "every"
    """Each counts, in order; of more than 100 that wait the oldest goes."""

    COMMAND = "command"
    """As EVERY, and sent without waiting for more to send with it."""

    FRESH = "fresh"
    """As NEWEST, and of no use when it is late: what is lost is not sent again. Its subscribers are not LOSSLESS."""

    LOSSLESS = "lossless"
    """As EVERY, and none is lost: sending waits for who listens. For a source that can be slowed down."""
