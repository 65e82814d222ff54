"""The file of the lease: complete or not there, and damage is no reason not to start."""

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from ur_nodes.motion.lease.text import FREE, Lease, LeaseStore, Viewer, make_store

LEASE = Lease("held", "a", "laptop", "keyboard_drive", 1.8e9, False, (Viewer("b", "desktop"),), computer="c1")


@pytest.fixture
def store(tmp_path: Path) -> LeaseStore:
    environment = {"ROS_HOME": str(tmp_path), "ROS_MASTER_URI": "http://bob.local:11311"}
    return make_store(environment, "/robot/cmd_vel_mux", "run-1")


def test_lease_is_read_as_it_was_saved_and_its_run_of_the_master_is_known(store: LeaseStore) -> None:
    assert store.load() == (None, True)
    for lease in (LEASE, FREE):
        store.save(lease)
        assert store.load() == (lease, True)
        assert LeaseStore(store.path, "run-2").load() == (lease, False)
    store.clear()
    store.clear()
    assert store.load() == (None, True)


def test_each_mux_of_each_master_has_a_file_of_its_own(tmp_path: Path) -> None:
    made = {
        make_store({"HOME": str(tmp_path), "ROS_MASTER_URI": uri}, mux, "").path
        for uri in ("http://a:1", "http://a:2")
        for mux in ("/mux", "/a/mux", "/a.mux")
    }
    assert len(made) == 6
    assert {path.parent for path in made} == {tmp_path / ".ros" / "ur_lease"}


def test_each_domain_of_ros2_has_a_file_of_its_own_in_every_shell(tmp_path: Path) -> None:
    def path_of(**environment: str) -> Path:
        return make_store({"HOME": str(tmp_path), "ROS_VERSION": "2", **environment}, "/mux", "").path

    assert path_of(ROS_DOMAIN_ID="1") != path_of(ROS_DOMAIN_ID="2")
    assert path_of(ROS_DOMAIN_ID="0") == path_of() == path_of(ROS_MASTER_URI="http://a:1")


@pytest.mark.parametrize(
    "content",
    [b"", b"{", b"[]", b"\xff\xfe", b"[" * 9999, b'{"run": "run-1", "lease": {"state": "held"}}', b'{"lease": 1}'],
)
def test_damaged_file_counts_as_none(store: LeaseStore, content: bytes) -> None:
    store.path.parent.mkdir()
    store.path.write_bytes(content)
    assert store.load()[0] is None


def test_lease_is_on_the_disk_before_the_file_takes_the_place_of_the_one_before(
    store: LeaseStore,
) -> None:
    store.save(FREE)
    seen: list[Lease | None] = []

    def note(descriptor: int) -> None:
        seen.append(store.load()[0])
        os.fsync(descriptor)

    replace(store, sync=note).save(LEASE)
    assert seen == [FREE, LEASE]  # the content of the new file, then its name


def test_lease_that_cannot_be_saved_leaves_no_older_one(store: LeaseStore) -> None:
    store.save(LEASE)

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space left"):
        replace(store, sync=fail).save(FREE)
    assert list(store.path.parent.iterdir()) == []


def test_file_is_private_and_small(store: LeaseStore) -> None:
    store.save(LEASE)
    assert store.path.stat().st_mode & 0o777 == 0o600
    assert set(json.loads(store.path.read_text())) == {"run", "lease"}
