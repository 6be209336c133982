"""Who may ask the server anything: the page that it has served itself, and nobody else.

A page of any other site may send requests to 127.0.0.1 from the same browser, and a name of its own may be made to
resolve there (DNS rebinding). So three things are asked of each request: that it was sent to this very address, by the
``Host`` header; that its path begins with a secret that only the page knows; and where the browser says who sends it
(``Origin``, ``Sec-Fetch-Site``), that it is the page. What changes anything must come with a header that no other site
can add without asking first, which the server never allows. There is no cookie: browsers send one to every port.
"""

from __future__ import annotations

import secrets
import threading
from dataclasses import dataclass
from email.message import Message
from http import HTTPStatus

ADDRESS = "127.0.0.1"
OWN_HEADER = "X-Halltwin-Lab"
"""Set by the page's script on each request that does something."""
_TOKEN_BYTES = 32
_LONGEST_PATH = 2048

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Cache-Control": "no-store",
}
"""Of every reply: no script but the page's own, nothing from elsewhere, in no other page's frame, kept nowhere."""


@dataclass(frozen=True)
class Refusal(Exception):
    """A request that is not answered: the status, and the line that says why."""

    status: HTTPStatus
    why: str


def new_token() -> str:
    """The secret of one run of the server."""
    return secrets.token_urlsafe(_TOKEN_BYTES)


class Door:
    """A way to the page that works once: what a browser is started with, all users of the machine can list."""

    PREFIX = "/open/"

    def __init__(self) -> None:
        self._lock, self._code = threading.Lock(), new_token()

    @property
    def path(self) -> str:
        """The path that leads there."""
        return f"{self.PREFIX}{self._code}"

    def passed(self, path: str) -> bool:
        """Whether this is the path, for the first time."""
        with self._lock:
            right = bool(self._code) and secrets.compare_digest(path.encode(), self.path.encode())
            if right:
                self._code = ""
            return right


@dataclass(frozen=True)
class Guard:
    """The address that the server listens at, and its secret."""

    port: int
    token: str

    @property
    def origin(self) -> str:
        """What the browser calls the page's own site."""
        return f"http://{ADDRESS}:{self.port}"

    @property
    def url(self) -> str:
        """The page, with the secret in its path: all that it loads and asks lies below it."""
        return f"{self.origin}/{self.token}/"

    def check_host(self, headers: Message) -> None:
        """Refuse what was sent to another name of this address. Raises Refusal."""
        if headers.get_all("Host") != [f"{ADDRESS}:{self.port}"]:
            raise Refusal(HTTPStatus.FORBIDDEN, "this server answers to its own address alone")

    def admitted(self, method: str, path: str, headers: Message) -> str:
        """The path below the secret. Raises Refusal."""
        self.check_host(headers)
        _, _, rest = path.partition("/")
        token, slash, below = rest.partition("/")
        if headers.get_all("Origin", [self.origin]) != [self.origin]:
            raise Refusal(HTTPStatus.FORBIDDEN, "the request comes from another site")
        # A person may come to the page itself from anywhere, as from a terminal that is a page of another site.
        comes = method == "GET" and not below and headers.get("Sec-Fetch-Dest") == "document"
        if not comes and headers.get("Sec-Fetch-Site", "same-origin") not in ("same-origin", "none"):
            raise Refusal(HTTPStatus.FORBIDDEN, "the request comes from another site")
        if len(path) > _LONGEST_PATH or not slash or not secrets.compare_digest(token.encode(), self.token.encode()):
            raise Refusal(HTTPStatus.FORBIDDEN, "the address lacks its secret: open the one that halltwin lab printed")
        if method == "POST" and OWN_HEADER not in headers:
            raise Refusal(HTTPStatus.FORBIDDEN, "the request does not come from the page")
        return below
