"""Times as files hold them: long enough for every rig, short enough to be counted in nanoseconds."""

from typing import Annotated

from pydantic import Field

#: A day.
LONGEST_S = 86_400.0

Milliseconds = Annotated[float, Field(ge=0, le=1000.0 * LONGEST_S)]
Seconds = Annotated[float, Field(ge=0, le=LONGEST_S)]
SomeSeconds = Annotated[float, Field(gt=0, le=LONGEST_S)]
