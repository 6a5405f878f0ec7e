"""Long work in a process of its own: an order as a line of JSON in, lines of progress and at last the answer out.

So the page answers meanwhile, the work can be stopped at any instant, and what it breaks is not the page.
"""

import json
import sys
from typing import Any

from hilplant.failure import Failure
from hilplant.modelling.long_work import WORKS, plain
from hilplant.progress import ProgressReport


def main() -> int:
    """Do what the order asks for."""
    order = json.loads(sys.stdin.readline())
    work = WORKS[order.pop("work")]
    try:
        answer = work(order, lambda seen: _tell("progress", _shown(seen)))
    except Failure as error:
        _tell("failed", str(error))
        return 2
    except KeyboardInterrupt:
        _tell("stopped", "")
        return 1
    _tell("done", answer)
    return 0


def _shown(seen: ProgressReport) -> dict[str, Any]:
    return {"stage": seen.stage, "done": seen.done, "total": seen.total, "note": seen.note}


def _tell(kind: str, content: Any) -> None:
    sys.stdout.write(json.dumps({"kind": kind, "content": plain(content)}) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
