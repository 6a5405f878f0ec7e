"""The page of the modelling tool: its files, its requests, and the server that gives them out on this machine."""

import asyncio
import tempfile
from collections.abc import Callable
from pathlib import Path

from hilplant.modelling.opening import open_model
from hilplant.modelling.routes import routes
from hilplant.modelling.session import ModellingSession
from hilplant.web.access import Access, AccessLimits
from hilplant.web.application import Page, application
from hilplant.web.serving import Address, serve

#: Recordings are uploaded, some of them long.
LIMITS = AccessLimits(body_bytes=200_000_000)
_STATIC = Path(__file__).parent / "static"


def modelling_page(session: ModellingSession) -> Page:
    """Return the page for a session."""
    return Page(_STATIC, routes(session))


def serve_modelling(bench: str, address: Address, ready: Callable[[str], None]) -> None:
    """Open a bench and serve its page until SIGINT or SIGTERM; `ready` is told the address to open.

    Raises
    ------
    Failure
        When there is no such bench, or nothing can listen at the address.

    """
    model = open_model(bench)
    with tempfile.TemporaryDirectory(prefix="hilplant-modelling-") as work:
        session, access = ModellingSession(model, Path(work)), Access(LIMITS)
        try:
            asyncio.run(serve(application(modelling_page(session), access), access, address, ready))
        finally:
            session.jobs.stop()
