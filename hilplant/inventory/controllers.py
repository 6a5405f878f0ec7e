"""Where the controllers of :mod:`hilplant.control.catalogue` come from."""

from hilplant.control.records import RULES

_THESIS = "Dooner (2016)"
_SEARCH = "differential evolution, seed 1 (docs/control.md)"
_ASSUMED = "initial weights, which the source does not print, chosen to come near"


def _neurons() -> dict[str, tuple[str, str, str]]:
    found: dict[str, tuple[str, str, str]] = {}
    for rule in RULES:
        name = "-".join(word.capitalize() for word in rule.split("_"))
        found |= {
            rule: (
                f"single neuron, {name} rule, K without overshoot",
                "published",
                f"{_THESIS}, Tables 7-4 and 7-5; {_ASSUMED}",
            ),
            f"{rule}_fuzzy": (
                f"single neuron, {name} rule, fuzzy K",
                "published",
                f"{_THESIS}, 7.4 and Table 7-6; {_ASSUMED}",
            ),
            f"{rule}_calm": (f"single neuron, {name} rule, gains searched, no overshoot", "identified", _SEARCH),
            f"{rule}_quick": (
                f"single neuron, {name} rule, fuzzy K, gains searched, overshoot up to 0.6 rad/s",
                "identified",
                _SEARCH,
            ),
        }
    return found


#: What each is, its status, and its source; `_sensorless` behind a name takes an observer in place of the sensor.
CONTROLLERS: dict[str, tuple[str, str, str]] = {
    "pid": ("PID with the gains of Table 7-1", "published", f"{_THESIS}, Table 7-1"),
    "pid_imc": ("PI by internal model control", "assumed", "tuned by a stated rule (docs/control.md)"),
    **_neurons(),
    "cascade": ("speed, current, and an observer of the load torque", "assumed", "own design (docs/control.md)"),
}
