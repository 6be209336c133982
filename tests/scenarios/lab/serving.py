"""A server of the page for a test, and a browser's requests without a browser."""

from __future__ import annotations

import contextlib
import json
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

from scenarios.lab import twins
from scenarios.lab.guard import ADDRESS, OWN_HEADER
from scenarios.lab.server import Server
from scenarios.lab.session import Session


@dataclass(frozen=True)
class Answer:
    """What came back."""

    status: int
    headers: dict[str, str]
    content: bytes

    @property
    def json(self) -> Any:
        """The content as plain values."""
        return json.loads(self.content)

    @property
    def error(self) -> str:
        """The one line that says what is wrong."""
        said: str = self.json["error"]
        assert said
        assert "\n" not in said
        return said


@dataclass(frozen=True)
class Client:
    """Asks a server as its page does, or otherwise."""

    server: Server

    def ask(
        self, path: str, content: Any = None, *, body: bytes | None = None, method: str | None = None, **headers: str
    ) -> Answer:
        """The answer to a path below the secret: to a question where there is a content, to a file with a body."""
        data = json.dumps(content).encode() if body is None and content is not None else body
        return self.raw(f"/{self.server.guard.token}/{path}", data, method=method, **headers)

    def raw(self, path: str, body: bytes | None = None, *, method: str | None = None, **headers: str) -> Answer:
        """The answer to a whole path; a header of the value "" is left out."""
        verb = method or ("GET" if body is None else "POST")
        sent = {"Host": f"{ADDRESS}:{self.server.guard.port}", **({OWN_HEADER: "1"} if verb == "POST" else {})}
        sent |= {name.replace("_", "-"): value for name, value in headers.items()}
        connection = HTTPConnection(ADDRESS, self.server.guard.port, timeout=60)
        with contextlib.closing(connection):
            connection.putrequest(verb, path, skip_host=True, skip_accept_encoding=True)
            for name, value in sent.items():
                if value:
                    connection.putheader(name, value)
            if body is not None and "Content-Length" not in sent:
                connection.putheader("Content-Length", str(len(body)))
            connection.endheaders(body)
            reply = connection.getresponse()
            return Answer(reply.status, dict(reply.getheaders()), reply.read())


@contextlib.contextmanager
def serving(folder: Path, twin: str = twins.DEFAULT) -> Iterator[Client]:
    """A server with a folder of its own, until the end."""
    session = Session(twins.named(twin), folder)
    server = Server(session.routes())
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
    thread.start()
    try:
        yield Client(server)
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
        session.close()
