import pytest
from bench.navigation_parts.spin import measure_spin


@pytest.mark.parametrize("speed", [1.5, -1.5])
def test_walls_on_the_local_costmap_of_a_robot_that_turns_are_where_they_are(speed: float) -> None:
    off, turned = measure_spin("create2:lidar", 5.0, speed, 0, seconds=2)
    assert turned == pytest.approx(speed, rel=0.02)
    assert len(off) > 100
    assert off.max() < 0.15
