from dataclasses import replace

import pytest
import yaml
from tests.robot.image.images import KEY

from ur.robot.image.layout import Layout, Scheme
from ur.robot.image.seed import (
    HostKeyPair,
    SeedNetwork,
    SeedOptions,
    accepts_host_key,
    custom_toml,
    hide_secrets,
    make_seed,
    meta_data_text,
    network_text,
    present_host_key,
    present_password,
    user_data_text,
)
from ur.robot.setup.robot_states import WantedRobot
from ur.source.diagnostic import UserError

HASH = "$6$saltstring$svn8UoSVapNtMuq1ukKS4tPQd8iKwSMHWjl/O817G3uBnIFNjnQJuesI68u4OTLiBFdcbYEdFCoEOfaS35inz1"
NETWORK_KEY = "1234567890" * 6 + "1234"
OPTIONS = SeedOptions(WantedRobot("bob", "magni"), "ros", (KEY,))
WIFI = SeedNetwork('My "WiFi": yes', NETWORK_KEY, "DE")
LAYOUT = Layout(Scheme.BOOT_SEED, "a system", None, None)


def test_user_without_a_password_logs_in_by_key_and_may_use_sudo() -> None:
    data = yaml.safe_load(user_data_text(OPTIONS))
    (user,) = data["users"]
    assert user["ssh_authorized_keys"] == [KEY]
    assert (user["lock_passwd"], user["sudo"]) == (True, "ALL=(ALL) NOPASSWD:ALL")
    assert data["ssh_pwauth"] is False


def test_user_with_a_password_is_asked_for_it_by_sudo() -> None:
    (user,) = yaml.safe_load(user_data_text(replace(OPTIONS, password=HASH)))["users"]
    assert (user["lock_passwd"], user["passwd"]) == (False, HASH)
    assert "sudo" not in user
    assert "sudo" in user["groups"]


def test_name_is_set_once_and_kept_afterwards() -> None:
    data = yaml.safe_load(user_data_text(OPTIONS))
    assert (data["hostname"], data["preserve_hostname"]) == ("bob", False)
    files = {each["path"]: each["content"] for each in data["write_files"]}
    assert yaml.safe_load(files["/etc/cloud/cloud.cfg.d/99-ubiquity.cfg"])["preserve_hostname"] is True
    assert yaml.safe_load(files["/etc/ubiquity/robot.yaml"]) == {"name": "bob", "base": "magni"}
    assert "<txt-record>user=ros</txt-record>" in files["/etc/avahi/services/ubiquity.service"]


def test_first_boot_waits_for_no_package() -> None:
    assert "packages" not in yaml.safe_load(user_data_text(OPTIONS))


def test_network_names_and_keys_survive_yaml() -> None:
    data = yaml.safe_load(network_text(WIFI))
    radio = data["wifis"]["wlan0"]
    assert radio["access-points"] == {'My "WiFi": yes': {"password": NETWORK_KEY}}
    assert radio["regulatory-domain"] == "DE"
    assert data["version"] == 2
    assert yaml.safe_load(network_text(replace(WIFI, country="NO")))["wifis"]["wlan0"]["regulatory-domain"] == "NO"


def test_open_network_has_no_password() -> None:
    radio = yaml.safe_load(network_text(replace(WIFI, key="")))["wifis"]["wlan0"]
    assert radio["access-points"] == {'My "WiFi": yes': {}}


def test_another_seed_is_another_instance_and_the_same_is_not() -> None:
    one, again, other = (yaml.safe_load(meta_data_text(text))["instance-id"] for text in ("a", "a", "b"))
    assert one == again != other


def test_wired_robot_keeps_the_network_of_its_image() -> None:
    assert {file.path for file in make_seed(OPTIONS, LAYOUT)} == {"user-data", "meta-data"}


def test_raspberry_pi_os_gets_an_ssh_server_and_its_radio_switched_on() -> None:
    files = {file.path: file.text for file in make_seed(replace(OPTIONS, wifi=WIFI), replace(LAYOUT, raspberry=True))}
    assert set(files) == {"user-data", "meta-data", "network-config", "ssh"}
    assert any("do_wifi_country DE" in line[2] for line in yaml.safe_load(files["user-data"])["runcmd"])


def test_cloud_image_gets_its_seed_in_the_system() -> None:
    files = make_seed(OPTIONS, replace(LAYOUT, scheme=Scheme.ROOT_SEED))
    assert {(file.volume, file.path) for file in files} == {
        ("root", "var/lib/cloud/seed/nocloud/user-data"),
        ("root", "var/lib/cloud/seed/nocloud/meta-data"),
    }


@pytest.mark.parametrize(
    ("version", "good"), [("0.104-0ubuntu2", False), ("0.105-0ubuntu2~22.04.1", True), ("1.0", True), ("", True)]
)
def test_netplan_that_knows_no_country_is_refused(version: str, good: bool) -> None:
    options, layout = replace(OPTIONS, wifi=WIFI), replace(LAYOUT, netplan=version)
    if good:
        assert make_seed(options, layout)
    else:
        with pytest.raises(UserError, match=r"0\.105"):
            make_seed(options, layout)


def test_custom_toml_holds_what_raspberry_pi_os_12_reads() -> None:
    tomllib = pytest.importorskip("tomllib", reason="Python before 3.11 reads no TOML")
    data = tomllib.loads(custom_toml(replace(OPTIONS, password=HASH, wifi=WIFI, timezone="Europe/Berlin")))
    assert data == {
        "config_version": 1,
        "system": {"hostname": "bob"},
        "user": {"name": "ros", "password": HASH, "password_encrypted": True},
        "ssh": {"enabled": True, "password_authentication": False, "authorized_keys": [KEY]},
        "wlan": {"ssid": 'My "WiFi": yes', "password": NETWORK_KEY, "password_encrypted": True, "country": "DE"},
        "locale": {"timezone": "Europe/Berlin"},
    }


def test_hashes_are_found_again_and_never_shown() -> None:
    text = user_data_text(replace(OPTIONS, password=HASH)) + network_text(WIFI) + "password: ubuntu\n"
    assert present_password(["", text]) == HASH
    shown = hide_secrets(text)
    for secret in (HASH[3:], NETWORK_KEY, "ubuntu\n"):
        assert secret not in shown
    assert KEY in shown


PAIR = HostKeyPair("-----BEGIN OPENSSH PRIVATE KEY-----\nc2VjcmV0\n-----END OPENSSH PRIVATE KEY-----\n", KEY)


def test_host_key_is_brought_found_again_and_hidden() -> None:
    text = user_data_text(replace(OPTIONS, host_key=PAIR))
    assert yaml.safe_load(text)["ssh_keys"] == {"ed25519_private": PAIR.private, "ed25519_public": KEY}
    assert present_host_key(["", text], "bob") == PAIR
    assert present_host_key(["", text], "eve") is None  # another robot gets one of its own
    assert "c2VjcmV0" not in hide_secrets(text)
    assert "c2VjcmV0" not in repr(PAIR)
    assert "ssh_keys" not in user_data_text(OPTIONS)


def test_system_that_makes_its_own_host_key_gets_none() -> None:
    assert accepts_host_key(LAYOUT)
    assert not accepts_host_key(replace(LAYOUT, scheme=Scheme.CUSTOM_TOML))
