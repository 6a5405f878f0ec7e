"""From what a bench says about the ECU to the controller's settings."""

from hilplant.bench.ecu_description import ControllerSettings
from hilplant.ecu.vocabulary import RelaySettings


def controller_settings(written: ControllerSettings) -> RelaySettings:
    """Return the controller's settings; the bench's names are the controller's."""
    return RelaySettings(**{name: getattr(written, name) for name in RelaySettings._fields})
