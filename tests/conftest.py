"""Settings of all tests: random searches repeat the same examples, so that a failure is never a matter of luck.

To search anew: HILPLANT_SEARCH=1 python -m pytest tests/property
"""

import os

from hypothesis import settings

settings.register_profile("same examples", derandomize=True)
settings.register_profile("new examples", derandomize=False)
settings.load_profile("new examples" if os.environ.get("HILPLANT_SEARCH") else "same examples")
