"""What a bench may say of a message's end-to-end protection."""

from typing import Any

from pydantic import Field

from hilplant.checked_yaml.checked import Checked

#: Profiles of AUTOSAR E2E that are known, and the ways in which a data id enters a checksum.
E2E_PROFILES = (1, 2, 4, 5, 6, 7, 11)
DATA_ID_MODES = ("both", "alternating", "low", "nibble")


def _of_a_state(what: str) -> Any:
    return Field(default=None, ge=0, description=f"{what}, as in the system description")


class StateMachineSection(Checked):
    """AUTOSAR's E2E state machine: how many of the last checks count in each state, and what they must have found."""

    window_size_init: int | None = _of_a_state("checks that count in INIT")
    window_size_valid: int | None = _of_a_state("checks that count in VALID, the largest window")
    window_size_invalid: int | None = _of_a_state("checks that count in INVALID")
    min_ok_state_init: int | None = _of_a_state("good ones that lead from INIT to VALID")
    max_error_state_init: int | None = _of_a_state("wrong ones that INIT allows")
    min_ok_state_valid: int | None = _of_a_state("good ones that keep VALID")
    max_error_state_valid: int | None = _of_a_state("wrong ones that VALID allows")
    min_ok_state_invalid: int | None = _of_a_state("good ones that lead from INVALID to VALID")
    max_error_state_invalid: int | None = _of_a_state("wrong ones that this way allows")
    clear_from_valid_to_invalid: bool | None = Field(
        default=None, description="whether checks before INVALID are forgotten; no when left out"
    )


class ProtectionSection(Checked):
    """AUTOSAR end-to-end protection of a message; which keys go together is checked with the message's length."""

    profile: int | None = Field(default=None, description="E2E profile", json_schema_extra={"enum": list(E2E_PROFILES)})
    data_id: int | None = Field(default=None, ge=0, description="number of the message that both ends know")
    data_id_list: list[int] | None = Field(
        default=None, description="16 numbers from 0 to 255 instead of data_id, profile 2"
    )
    offset: int | None = Field(default=None, ge=0, description="byte at which the header starts; 0 when left out")
    max_delta_counter: int | None = Field(
        default=None, ge=1, description="largest accepted step of the counter; 1: no loss"
    )
    data_id_mode: str | None = Field(
        default=None, description="how data_id enters the checksum", json_schema_extra={"enum": list(DATA_ID_MODES)}
    )
    state_machine: StateMachineSection | None = Field(
        default=None, description="AUTOSAR's E2E state machine; each frame is judged alone when left out"
    )

    def settings(self) -> dict[str, Any]:
        """Return the keys that are given."""
        return self.model_dump(exclude_unset=True)
