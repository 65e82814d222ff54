"""Parameters that detection and mapping share, with the names of aruco_detect."""

from __future__ import annotations

from ur_nodes.rosio.parameters import Parameters
from ur_nodes.vision.detect import Sizes
from ur_nodes.vision.sizes import parse_numbers, parse_sizes


def read_sizes(own: Parameters) -> Sizes:
    """`~fiducial_len`, `~fiducial_len_override`, `~ignore_fiducials`. Raises UserError."""
    usual = own.number("fiducial_len", 0.14, minimum=0.005, maximum=10.0)
    special, ignored = own.text("fiducial_len_override", ""), own.text("ignore_fiducials", "")
    try:
        sizes = parse_sizes(special)
    except ValueError:
        own.fail("fiducial_len_override", special, "numbers and sizes in m, such as '3: 0.2, 7-9: 0.1'")
        raise AssertionError from None
    try:
        return Sizes(usual, sizes, parse_numbers(ignored))
    except ValueError:
        own.fail("ignore_fiducials", ignored, "numbers, such as '3, 7-9'")
        raise AssertionError from None
