from ur.web.access.rate import Buckets


def test_each_client_has_a_bucket_of_its_own() -> None:
    buckets = Buckets(rate=1.0, burst=2.0)
    assert [buckets.allows("a", 0.0) for _ in range(3)] == [True, True, False]
    assert buckets.allows("b", 0.0)
    assert [buckets.allows("a", 1.0) for _ in range(2)] == [True, False]


def test_memory_of_clients_is_bounded_and_those_that_came_last_stay() -> None:
    buckets = Buckets(rate=0.0, burst=1.0, most=3)
    for client in "abcd":
        assert buckets.allows(client, 0.0)
    assert not buckets.allows("d", 0.0)
    assert buckets.allows("a", 0.0)  # forgotten
