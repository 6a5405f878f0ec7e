"""Where the values of a tick lie in a row of the ring.

A row holds tick, deadline_ns, inputs, outputs, status, the plant's state before the tick, and the owners of the inputs,
as indices of ``commands.OWNERS``.
"""

from hilplant.models.records import STATE_INDEX
from hilplant.signals import INPUTS, OUTPUTS, STATUS

FIRST_INPUT = 2
FIRST_OUTPUT = FIRST_INPUT + len(INPUTS)
FIRST_STATUS = FIRST_OUTPUT + len(OUTPUTS)
FIRST_STATE = FIRST_STATUS + len(STATUS)
FIRST_OWNER = FIRST_STATE + len(STATE_INDEX)
ROW_WIDTH = FIRST_OWNER + len(INPUTS)
