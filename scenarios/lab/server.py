"""The server of the page: one person's browser on this machine, nothing from the network, no file by its name."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BufferedIOBase, BytesIO
from typing import Any
from urllib.parse import unquote

from scenarios.lab.assets import asset, guide_file
from scenarios.lab.guard import ADDRESS, HEADERS, Door, Guard, Refusal, new_token
from twin.errors import UserError
from twin.log import LOG

LARGEST_QUESTION_BYTES = 100_000
"""Most bytes of a question in JSON: a design has some fifty numbers, a toggled sweep fewer."""
LARGEST_UPLOAD_BYTES = 300_000_000
"""Most bytes of a file that is dropped on the page: a million readings in nine columns take 110 MB as text."""
FILE_NAME = "X-File-Name"
"""The header with the name of a dropped file, percent-encoded."""
_JSON = "application/json"


@dataclass(frozen=True)
class Upload:
    """A dropped file: the name it is called by, and its bytes, still to be read."""

    name: str
    size: int
    stream: BufferedIOBase


@dataclass(frozen=True)
class Reply:
    """What is answered; ``download`` names the file that a browser saves it as, ``to`` the page that it goes on to."""

    content: bytes
    kind: str = _JSON
    download: str | None = None
    to: str | None = None
    status: HTTPStatus = HTTPStatus.OK

    @classmethod
    def of(cls, content: Any, status: HTTPStatus = HTTPStatus.OK) -> Reply:
        """Plain values as JSON."""
        return cls(json.dumps(content, allow_nan=False, separators=(",", ":")).encode(), status=status)


@dataclass(frozen=True)
class Routes:
    """What the server answers below its secret, by path: things to get, questions in JSON, dropped files."""

    gets: dict[str, Callable[[], Reply]] = field(default_factory=dict)
    asks: dict[str, Callable[[Any], Reply]] = field(default_factory=dict)
    uploads: dict[str, Callable[[Upload], Reply]] = field(default_factory=dict)


class Server(ThreadingHTTPServer):
    """Listens on this machine alone, at a free port unless one is given. Raises OSError where that is taken."""

    daemon_threads = True
    allow_reuse_address = sys.platform != "win32"

    def __init__(self, routes: Routes, *, port: int = 0) -> None:
        super().__init__((ADDRESS, port), _Handler)
        self.routes = routes
        self.guard, self.door = Guard(self.server_address[1], new_token()), Door()


class _Handler(BaseHTTPRequestHandler):
    """One connection of the browser's."""

    server: Server
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "halltwin", ""
    disable_nagle_algorithm = True
    timeout = 120

    def do_GET(self) -> None:
        self._answer("GET")

    def do_POST(self) -> None:
        self._answer("POST")

    def _answer(self, method: str) -> None:
        """Reply to one request. One that was refused, or not read to its end, closes the connection."""
        try:
            if method == "GET" and self.path.startswith(Door.PREFIX):
                reply = self._led()
            else:
                below = self.server.guard.admitted(method, self.path, self.headers)
                reply = self._got(below) if method == "GET" else self._posted(below)
        except Refusal as refused:
            self.close_connection = True
            reply = Reply.of({"error": refused.why}, refused.status)
        except UserError as error:
            reply = Reply.of({"error": _one_line(str(error))}, HTTPStatus.BAD_REQUEST)
        except OSError as gone:
            LOG.info("lab: %s", gone)
            self.close_connection = True
            return
        except Exception as fault:
            sys.excepthook(type(fault), fault, fault.__traceback__)
            words = "this is a fault of the program, not of the input; the terminal says more"
            reply = Reply.of({"error": words}, HTTPStatus.INTERNAL_SERVER_ERROR)
        self._send(reply)

    def _led(self) -> Reply:
        """From the door to the page. Raises Refusal."""
        self.server.guard.check_host(self.headers)
        if not self.server.door.passed(self.path):
            raise Refusal(HTTPStatus.FORBIDDEN, "this address works once; open the one that halltwin lab printed")
        return Reply(b"", to=f"/{self.server.guard.token}/", status=HTTPStatus.SEE_OTHER)

    def _got(self, below: str) -> Reply:
        found = asset(below) or guide_file(below)
        if found is not None:
            return Reply(*found)
        if below not in self.server.routes.gets:
            raise Refusal(HTTPStatus.NOT_FOUND, "there is nothing of this name")
        return self.server.routes.gets[below]()

    def _posted(self, below: str) -> Reply:
        routes = self.server.routes
        if below in routes.asks:
            size = self._size(LARGEST_QUESTION_BYTES)
            return routes.asks[below](_plain_values(self.rfile.read(size)))
        if below not in routes.uploads:
            raise Refusal(HTTPStatus.NOT_FOUND, "there is nothing of this name")
        size = self._size(LARGEST_UPLOAD_BYTES)
        # Where the reading stops half way the rest of the file must not be taken for a request.
        self.close_connection = True
        return routes.uploads[below](Upload(unquote(self.headers.get(FILE_NAME, "")), size, self.rfile))

    def _size(self, most: int) -> int:
        """How many bytes follow. Raises Refusal."""
        told = self.headers.get("Content-Length", "")
        if "Transfer-Encoding" in self.headers or not (told.isascii() and told.isdigit()):
            raise Refusal(HTTPStatus.LENGTH_REQUIRED, "the request does not say how long it is")
        if len(told) > len(str(most)) or int(told) > most:
            raise Refusal(
                HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
                f"the file holds more than {most / 1e6:g} MB; give it to the command line instead",
            )
        return int(told)

    def _send(self, reply: Reply) -> None:
        """Send head and content in one piece: two would wake the browser twice."""
        line, whole = self.wfile, BytesIO()
        self.wfile = whole
        self._write(reply)
        self.wfile = line
        try:
            line.write(whole.getvalue())
        except OSError as gone:
            # The page was closed meanwhile.
            LOG.info("lab: %s", gone)
            self.close_connection = True

    def _write(self, reply: Reply) -> None:
        self.send_response(reply.status)
        for name, value in HEADERS.items():
            self.send_header(name, value)
        self.send_header("Content-Type", reply.kind)
        self.send_header("Content-Length", str(len(reply.content)))
        if reply.download is not None:
            self.send_header("Content-Disposition", f'attachment; filename="{reply.download}"')
        if reply.to is not None:
            self.send_header("Location", reply.to)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(reply.content)

    def log_message(self, format: str, *args: Any) -> None:
        """Requests are no news; the secret in their paths belongs into no log."""


def _plain_values(body: bytes) -> Any:
    """The JSON of a question. Raises UserError."""
    try:
        return json.loads(body, parse_constant=_refused)
    except RecursionError:
        raise UserError("the question holds lists too deep in one another; expected JSON of the page's") from None
    except ValueError:
        raise UserError("the question is no JSON; expected that of the page") from None


def _refused(name: str) -> Any:
    raise ValueError(name)


def _one_line(text: str) -> str:
    """A message as one line of printable letters."""
    return "".join(letter if letter.isprintable() else "?" for letter in " ".join(text.split()))
