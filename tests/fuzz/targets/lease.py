"""Leases and requests for them, which any computer of the network may send to a robot."""

from contextlib import suppress
from pathlib import Path

from tests.fuzz.target import Target

from ur.run.remote.lease import describe_lease, parse_lease
from ur_nodes.motion.lease.text import LeaseRequest, read_lease, read_request, write_lease, write_request

_WORDS = (
    *(
        b'"state"',
        b'"held"',
        b'"free"',
        b'"lost"',
        b'"client"',
        b'"asking"',
        b'"taken_from"',
        b'"answers"',
        b'"action"',
    ),
    *(
        b"NaN",
        b"Infinity",
        b"1e400",
        b"4294967296",
        b'"\\ud800"',
        b'"\\u001b"',
        b"null",
        b"[[1, 2]]",
        b'{"client": "a"}',
    ),
)


def _read(data: bytes, _: Path) -> None:
    text = data.decode(errors="replace")
    with suppress(ValueError, TypeError):
        assert describe_lease(parse_lease(text), "bob", 0.0).isprintable(), "control characters are shown"
    lease = read_lease(text)
    assert lease is None or read_lease(write_lease(lease)) == lease, "a lease is not read as it is written"
    request = read_request(text)
    if isinstance(request, LeaseRequest):
        assert read_request(write_request(request)) == request, "a request is not read as it is written"
        assert (request.name + request.program + request.client).isprintable()


TARGETS = (Target("lease", _read, _WORDS),)
