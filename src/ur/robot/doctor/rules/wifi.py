"""Wireless links: signal, rate and power saving; no findings without a wireless link."""

from collections.abc import Iterator

from ur.robot.doctor.findings import Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.ssh.shell import quote

WEAK_SIGNAL = -75.0  # dBm; below, rates fall and packets get lost
SLOW_RATE = 12.0  # Mbit/s; a compressed camera image at 30 Hz needs about that


def check_wifi(where: Where, side: Side) -> Iterator[Finding]:
    """Check each wireless link that is up."""
    for wifi in side.wifi:
        if wifi.signal is not None and wifi.signal < WEAK_SIGNAL:
            yield Finding(
                "weak-wifi",
                f"{side.name}: the signal at {wifi.device} is {wifi.signal:.0f} dBm, "
                f"expected above {WEAK_SIGNAL:.0f} dBm",
                "nearer to the access point, or an antenna outside metal; measure with 'ur doctor ROBOT --wireless'",
            )
        elif wifi.rate is not None and wifi.rate < SLOW_RATE:
            band = f" in the {wifi.band} band" if wifi.band else ""
            yield Finding(
                "slow-wifi",
                f"{side.name}: {wifi.device} sends with {wifi.rate:g} Mbit/s{band} although the signal is good, "
                f"expected {SLOW_RATE:g} Mbit/s or more",
                "another channel; "
                + ("5 GHz: a dual band (802.11ac) adapter" if wifi.band == "2.4 GHz" else "fewer computers on it"),
            )
        if wifi.power_save:
            yield Finding(
                "wifi-power-save",
                f"{side.name}: {wifi.device} saves power, so what is sent to it may wait 100 ms and more",
                "for good: sudo nmcli connection modify NAME 802-11-wireless.powersave 2",
                (FixCommand(where, f"iw dev {quote(wifi.device)} set power_save off", root=True, safe=True),),
            )


RULES: tuple[Rule, ...] = (
    SideRule(
        {
            "weak-wifi": "the signal is too weak",
            "slow-wifi": "the link is slow although the signal is good",
            "wifi-power-save": "packets wait until the adapter wakes up",
        },
        check_wifi,
    ),
)
