"""First contact: which host keys need the user's word, and which are refused whatever the user says."""

from pathlib import Path

import pytest

from ur.robot.setup.contact import OfferedHostKey, forget_contact, is_noted, needs_answer, note_contact
from ur.robot.ssh.address import Address
from ur.robot.ssh.host_key import HostKey
from ur.source.diagnostic import UserError

ADDRESS = Address("ros", "robot.local")
KEY = HostKey(f"ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAI{'A' * 43}")
OTHER = f"SHA256:{'x' * 43}"


def test_unknown_key_needs_an_answer_and_a_given_fingerprint_is_one() -> None:
    contact = OfferedHostKey("unknown", KEY)
    assert needs_answer(ADDRESS, contact)
    assert not needs_answer(ADDRESS, contact, fingerprint=KEY.fingerprint)
    assert contact.is_first
    assert contact.pinned == KEY


@pytest.mark.parametrize("state", ["unknown", "changed", "known", "confirmed"])
def test_another_key_than_the_given_one_is_refused(state: str) -> None:
    with pytest.raises(UserError, match=r"its host key is SHA256:.*, expected SHA256:xxx"):
        needs_answer(ADDRESS, OfferedHostKey(state, KEY), fingerprint=OTHER, new_host_key=True)  # type: ignore[arg-type]


def test_changed_key_needs_the_word_that_it_may_and_an_answer() -> None:
    contact = OfferedHostKey("changed", KEY)
    with pytest.raises(UserError, match="expected the one that is known") as caught:
        needs_answer(ADDRESS, contact)
    assert "--new-host-key" in (caught.value.diagnostics[0].help or "")
    assert needs_answer(ADDRESS, contact, new_host_key=True)
    assert not needs_answer(ADDRESS, contact, fingerprint=KEY.fingerprint)


def test_known_key_is_left_to_ssh_and_one_of_an_interrupted_set_up_is_insisted_on() -> None:
    assert not needs_answer(ADDRESS, OfferedHostKey("known"))
    assert OfferedHostKey("known", KEY).pinned is None
    assert not needs_answer(ADDRESS, OfferedHostKey("confirmed", KEY))
    assert OfferedHostKey("confirmed", KEY).pinned == KEY
    assert not OfferedHostKey("confirmed", KEY).is_first


def test_key_is_noted_until_it_is_forgotten(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert not is_noted(KEY)
    note_contact(KEY)
    note_contact(KEY)
    assert is_noted(KEY)
    forget_contact(KEY)
    forget_contact(KEY)
    assert not is_noted(KEY)
