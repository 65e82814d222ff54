import pytest

from ur.robot.commit_confirm.choice import choose_network, find_known, refuse_wireless
from ur.robot.commit_confirm.network_facts import NetworkDevice, Networks, Profile, SeenNetwork
from ur.source.diagnostic import UserError

HOME = Profile("u-home", "802-11-wireless", "wlan0", "at home", "Home")
SEEN = (
    SeenNetwork("Home", 80, ("5",), "WPA2"),
    SeenNetwork("Lab", 60, ("2.4",), "WPA2"),
    SeenNetwork("Cafe", 40, ("2.4",), ""),
)
NETWORKS = Networks(True, profiles=(HOME,), seen=SEEN)


def no_answer(_known: bool) -> str:
    return ""


def test_missing_password_is_asked_for_with_whether_one_is_known() -> None:
    asked: list[bool] = []

    def answer(known: bool) -> str:
        asked.append(known)
        return "12345678"

    for ssid in ("Home", "Lab", "Cafe"):
        choose_network(NETWORKS, ssid, "", answer, hidden=False, band="")
    assert asked == [True, False]


def test_known_network_without_a_password_keeps_its_profile() -> None:
    chosen = choose_network(NETWORKS, "Home", "", no_answer, hidden=False, band="5")
    assert (chosen.password, chosen.management, chosen.band) == (None, "", "5")


@pytest.mark.parametrize(
    ("ssid", "message"), [("Labb", "sees no network of this name, expected one in reach: Home"), ("Lab", "a password")]
)
def test_network_that_cannot_be_joined_is_refused(ssid: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        choose_network(NETWORKS, ssid, "", no_answer, hidden=False, band="")


def test_only_a_known_network_can_be_forgotten() -> None:
    assert find_known(NETWORKS, "Home") == HOME
    with pytest.raises(UserError, match="expected one of: Home") as caught:
        find_known(NETWORKS, "Hone")
    assert caught.value.diagnostics[0].help == "did you mean 'Home'?"


def test_robot_without_a_wireless_device_is_refused() -> None:
    wired = Networks(True, (NetworkDevice("eth0", "ethernet", "connected"),))
    with pytest.raises(UserError, match="no wireless device"):
        refuse_wireless("bob", wired)
