import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.geometry.distance import squared_distances, strips


@given(st.integers(1, 20), st.integers(1, 20), st.integers(1, 9), st.integers(0, 2**32 - 1))
def test_squared_distances_agree_with_brute_force_within_the_reach(
    height: int, width: int, reach: int, seed: int
) -> None:
    marks = np.random.default_rng(seed).random((height, width)) < 0.05
    cells = np.argwhere(np.ones_like(marks))
    offsets = cells[:, None] - np.argwhere(marks)
    exact = np.square(offsets).sum(axis=2).min(axis=1, initial=10**6).reshape(marks.shape)
    found = squared_distances(marks, reach)
    near = exact <= reach**2
    assert (found[near] == exact[near]).all()
    assert (found[~near] > reach**2).all()


def test_strips_cover_each_row_once_with_their_margin() -> None:
    rows = np.arange(3000)
    covered = []
    for strip, around, inner in strips((3000, 400), 7):
        assert (rows[around][inner] == rows[strip]).all()
        assert around.start == max(0, strip.start - 7)
        assert around.stop == min(3000, strip.stop + 7)
        covered += rows[strip].tolist()
    assert covered == rows.tolist()
