"""The AUTOSAR E2E profiles: what their headers look like, and the library's functions for them."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from e2e import p01, p02, p04, p05, p06, p07, p11


class Profile(NamedTuple):
    """A profile's header: its bytes, where its counter lies, and the functions of the library."""

    header_bytes: int
    counter_byte: int
    counter_bits: int
    modulus: int
    id_bits: int
    protect: Callable[..., None]
    check: Callable[..., bool]
    id_modes: Mapping[str, int] = {}


_MODES_1 = {
    "both": p01.E2E_P01_DATAID_BOTH,
    "alternating": p01.E2E_P01_DATAID_ALT,
    "low": p01.E2E_P01_DATAID_LOW,
    "nibble": p01.E2E_P01_DATAID_NIBBLE,
}
_MODES_11 = {"both": p11.E2E_P11_DATAID_BOTH, "nibble": p11.E2E_P11_DATAID_NIBBLE}

PROFILES = {
    1: Profile(2, 1, 4, 15, 16, p01.e2e_p01_protect, p01.e2e_p01_check, _MODES_1),
    2: Profile(2, 1, 4, 16, 0, p02.e2e_p02_protect, p02.e2e_p02_check),
    4: Profile(12, 2, 16, 1 << 16, 32, p04.e2e_p04_protect, p04.e2e_p04_check),
    5: Profile(3, 2, 8, 1 << 8, 16, p05.e2e_p05_protect, p05.e2e_p05_check),
    6: Profile(5, 4, 8, 1 << 8, 16, p06.e2e_p06_protect, p06.e2e_p06_check),
    7: Profile(20, 12, 32, 1 << 32, 32, p07.e2e_p07_protect, p07.e2e_p07_check),
    11: Profile(2, 1, 4, 15, 16, p11.e2e_p11_protect, p11.e2e_p11_check, _MODES_11),
}
