import pytest
from tests.ur_nodes.drivers.sensor_faults import FAULTS, try_fault


@pytest.mark.parametrize(("sensor", "name"), [(sensor, name) for sensor, faults in FAULTS.items() for name in faults])
def test_sensor_measures_again_after_a_fault_and_nothing_wrong_during_it(sensor: str, name: str) -> None:
    assert try_fault(sensor, name, 0) == []
