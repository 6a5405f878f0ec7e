"""The types of arrays, once for all rooms."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Whole = NDArray[np.int64]
#: Of records, such as frames and events.
Records = NDArray[np.void]
#: Of any type.
AnyArray = NDArray[Any]
