"""Advice about a wireless link, in one line, from its last seconds. Pure."""

from collections.abc import Sequence

from ur.robot.doctor.rules.network import LATENCY_SECONDS
from ur.robot.doctor.rules.wifi import SLOW_RATE, WEAK_SIGNAL
from ur.robot.doctor.wifi import WirelessLink
from ur.robot.wireless.sample import Sample, summarize

RECENT = 10  # s
LOSS = 0.01  # noticeable when driving


def advise(samples: Sequence[Sample], names: tuple[str, str]) -> str:
    """Return one sentence of advice. `names` are the names of this computer and of the robot."""
    recent = samples[-RECENT:]
    if not recent or not any(sample.sent for sample in samples):
        return "measuring ..."
    if recent[-1].gap:
        return _explain_gap(samples, names[1])
    links = [(name, link) for name, link in zip(names, (recent[-1].here, recent[-1].there), strict=True) if link]
    for name, link in links:
        if link.signal is not None and link.signal < WEAK_SIGNAL:
            weak = f"the signal at {name} is weak ({link.signal:.0f} dBm)"
            return f"{weak}: nearer to the access point, or an antenna in the open"
    whole = summarize(recent)
    middle = whole.latency[1] if whole.latency else 0.0
    slow = middle > LATENCY_SECONDS
    saving = [name for name, link in links if link.power_save]
    if slow and saving:
        return f"{middle * 1000:.0f} ms, and {saving[0]} saves power: ur doctor {names[1]} --fix"
    if whole.loss > LOSS:
        return f"{whole.loss:.0%} are lost: {_crowded(links)}"
    if slow:
        return f"packets wait: {_crowded(links)}"
    for name, link in links:
        if link.rate is not None and link.rate < SLOW_RATE:
            return f"{name} sends with {link.rate:g} Mbit/s only: {_crowded(links)}"
    return "good: compressed pictures and driving work here"


def _explain_gap(samples: Sequence[Sample], name: str) -> str:
    away = 0
    for sample in reversed(samples):
        if not sample.gap:
            break
        away += 1
    if away == len(samples):
        return f"{name} does not answer"
    return f"{name} has not answered for {away} s: go back to where it did, and put an access point between"


def _crowded(links: Sequence[tuple[str, WirelessLink]]) -> str:
    if any(link.band == "2.4 GHz" for _, link in links):
        return "the 2.4 GHz band is crowded: 5 GHz, with a dual band (802.11ac) adapter"
    return "another channel, or fewer computers on it" if links else "what else uses the network?"
