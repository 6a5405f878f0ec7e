"""Who may use a page: the token, the hosts and origins, sizes and rates; what is refused is counted by its reason."""

import hmac
import ipaddress
import secrets
import socket
from collections import Counter
from dataclasses import dataclass, field
from urllib.parse import urlsplit

#: Sent with every answer: nothing is loaded from elsewhere, nothing inline runs, no other page may frame this one.
HEADERS = {
    "content-security-policy": (
        "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "cache-control": "no-cache",
}


@dataclass(frozen=True, slots=True)
class AccessLimits:
    """How much one page may ask for: sockets at once, bytes of a message and of a request's body, messages."""

    sockets: int = 8
    message_bytes: int = 65536
    body_bytes: int = 1 << 20
    messages_per_s: float = 100.0
    burst: float = 200.0


@dataclass(slots=True)
class Access:
    """The rules of one server, and what it has refused since its start."""

    limits: AccessLimits = field(default_factory=AccessLimits)
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))
    refused: Counter[str] = field(default_factory=Counter)
    sockets: int = 0

    def knows(self, token: object) -> bool:
        """Whether this is the token; a comparison that takes as long for each wrong one."""
        return isinstance(token, str) and hmac.compare_digest(token.encode(errors="replace"), self.token.encode())

    def refuse(self, reason: str) -> None:
        """Count something that was refused."""
        self.refused[reason] += 1


def is_local_name(host: str) -> bool:
    """Whether a Host header names this server by an address, `localhost` or the machine's name.

    Any other name may have been pointed at this machine by somebody's name server (DNS rebinding).
    """
    name = _host_of(host)
    if name in ("localhost", socket.gethostname().lower(), socket.getfqdn().lower()):
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def is_own_origin(origin: str | None, host: str) -> bool:
    """Whether a request comes from the server's own pages; a program that is no browser names no origin."""
    return origin is None or origin.lower() == f"http://{host.lower()}"


def _host_of(host: str) -> str:
    try:
        return (urlsplit(f"//{host}").hostname or "").lower()
    except ValueError:
        return ""


class Rate:
    """A bucket of tokens: so many messages a second, and a burst of them at once."""

    def __init__(self, per_s: float, burst: float) -> None:
        """Begin with a full bucket."""
        self._per_s, self._burst, self._left, self._seen_s = per_s, burst, burst, 0.0

    def allows(self, now_s: float) -> bool:
        """Take one token, if one is left."""
        self._left = min(self._burst, self._left + (now_s - self._seen_s) * self._per_s)
        self._seen_s = now_s
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True
