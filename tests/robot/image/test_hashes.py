import pytest
from tests.robot.image.images import needs_tools

from ur.robot.image.seed import derive_network_key, hash_password, is_hash_of
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError


# IEEE 802.11i-2004, annex H.4.1
@pytest.mark.parametrize(
    ("network", "password", "key"),
    [
        ("IEEE", "password", "f42c6fc52df0ebef9ebb4b90b38a5f902e83fe1b135a70e23aed762e9710a12e"),
        ("ThisIsASSID", "ThisIsAPassword", "0dc0d6eb90555ed6419756b9a15ec3e3209b63df707dd508d14581f8982721af"),
        ("Z" * 32, "a" * 32, "becb93866bb8c3832cb777c2f559807c8c59afcb6eae734885001300a981cc62"),
    ],
)
def test_network_key_is_that_of_the_standard(network: str, password: str, key: str) -> None:
    assert derive_network_key(Secret(password), network) == key
    assert derive_network_key(Secret(key.upper()), network) == key


@pytest.mark.parametrize("password", ["seven77", "x" * 64, "grün-und-blau", "tab\tinside"])
def test_what_cannot_be_a_wifi_password_is_refused_without_showing_it(password: str) -> None:
    with pytest.raises(UserError) as caught:
        derive_network_key(Secret(password), "home")
    assert password not in str(caught.value)


@needs_tools
def test_hash_is_the_one_of_crypt_and_knows_its_password() -> None:
    # Ulrich Drepper, "Unix crypt using SHA-256 and SHA-512", test vectors
    known = "$6$saltstring$svn8UoSVapNtMuq1ukKS4tPQd8iKwSMHWjl/O817G3uBnIFNjnQJuesI68u4OTLiBFdcbYEdFCoEOfaS35inz1"
    assert hash_password(Secret("Hello world!"), "saltstring") == known
    hashed = hash_password(Secret("grün $x 'y"))
    assert hashed != hash_password(Secret("grün $x 'y"))
    assert is_hash_of(hashed, Secret("grün $x 'y"))
    assert not is_hash_of(hashed, Secret("other"))
    assert not is_hash_of("nonsense", Secret("other"))
