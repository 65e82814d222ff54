import pytest
from tests.ur_nodes.drivers.endurance import endure

from ur_nodes.drivers.registry import BOARDS, LIDARS


@pytest.mark.parametrize("name", sorted({*BOARDS, *LIDARS}))
def test_no_frame_is_lost_however_its_bytes_are_divided(name: str) -> None:
    sent, understood, rejected = endure(name, 0.05)
    assert sent > 10
    assert (sent - understood, rejected) == (0, 0)
