"""Random histories of a first drive."""

import pytest
from tests.ur_nodes.first_drive.histories import run_history


@pytest.mark.parametrize("seed", range(4))
def test_base_is_at_rest_soon_after_the_last_command_whatever_happened(seed: int) -> None:
    assert run_history(seed).problem == ""
