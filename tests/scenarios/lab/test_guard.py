"""Who the server answers to: its own page alone, with nothing from the file system but the page."""

from __future__ import annotations

import socket
from pathlib import Path
from urllib.parse import quote

import pytest

from scenarios.commands.guide.site import site
from scenarios.lab import server as served
from scenarios.lab.assets import ASSETS
from scenarios.lab.guard import ADDRESS, HEADERS
from tests.scenarios.lab.serving import Client, serving


def test_the_page_gets_what_it_is_made_of(client: Client) -> None:
    for name, (_, kind) in ASSETS.items():
        got = client.ask(name)
        assert got.status == 200
        assert got.headers["Content-Type"] == kind
        assert got.content


def test_the_guide_is_had_below_the_secret_and_nothing_else_of_its_folder(client: Client) -> None:
    for name, content in site().items():
        got = client.ask(f"guide/{name}")
        assert (got.status, got.content) == (200, content)
        assert got.headers["Content-Security-Policy"] == HEADERS["Content-Security-Policy"]
    assert client.ask("guide/index.html").headers["Content-Type"] == "text/html; charset=utf-8"
    for name in (
        "",
        "index.md",
        "../lab.html",
        "..%2flab.html",
        "index.html/",
        "index.html?x",
        "./index.html",
        "/etc/passwd",
    ):
        assert client.ask(f"guide/{name}").status == 404
    assert client.raw("/guide/index.html").status == 403
    assert client.ask("guide/index.html", Sec_Fetch_Site="cross-site", Sec_Fetch_Dest="document").status == 403


@pytest.mark.parametrize(
    "path", ["/", "/start", "/{wrong}/", "/{wrong}/start", "/{token}", "/{token}x/", "/{token}%2f"]
)
def test_nothing_is_had_without_the_secret(client: Client, path: str) -> None:
    token = client.server.guard.token
    wrong = token[:-1] + ("A" if token[-1] != "A" else "B")
    got = client.raw(path.format(token=token, wrong=wrong))
    assert got.status == 403
    assert "secret" in got.error
    assert token not in got.content.decode()


def test_the_secret_is_long_and_another_each_time(client: Client, tmp_path: Path) -> None:
    with serving(tmp_path) as other:
        assert other.server.guard.token != client.server.guard.token
    assert len(client.server.guard.token) >= 40


@pytest.mark.parametrize("host", ["localhost:{port}", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", ""])
def test_another_name_of_this_address_is_refused(client: Client, host: str) -> None:
    """A name that was made to lead here (DNS rebinding)."""
    got = client.ask("start", Host=host.format(port=client.server.guard.port))
    assert got.status == 403
    assert "its own address" in got.error


ELSEWHERE = (
    {"Origin": "http://evil.example"},
    {"Origin": "null"},
    {"Origin": "http://127.0.0.1:1"},
    {"Sec_Fetch_Site": "cross-site"},
    {"Sec_Fetch_Site": "same-site"},
)


@pytest.mark.parametrize("headers", ELSEWHERE)
@pytest.mark.parametrize("content", [None, {}])
def test_another_site_is_refused(client: Client, headers: dict[str, str], content: object) -> None:
    got = client.ask("design/map" if content is not None else "start", content, **headers)
    assert got.status == 403
    assert "another site" in got.error


@pytest.mark.parametrize(("name", "value"), [("oRiGin", "http://evil.example"), ("sec-fetch-site", "cross-site")])
def test_headers_are_known_by_any_letters(client: Client, name: str, value: str) -> None:
    assert client.ask("start", **{name: value}).status == 403
    assert client.ask("twin/preset", {"name": "imc-14bit"}, X_Halltwin_Lab="", **{"x-halltwin-lab": "1"}).status == 200


def test_two_hosts_are_none(client: Client) -> None:
    assert client.ask("start", host="evil.example").status == 403


def test_a_person_comes_to_the_page_from_anywhere_but_nothing_else_does(client: Client) -> None:
    """By a terminal that is a page of another site; a frame of one gets nothing."""
    comes = {"Sec_Fetch_Site": "cross-site", "Sec_Fetch_Dest": "document"}
    assert client.ask("", **comes).status == 200
    assert client.ask("start", **comes).status == 403
    assert client.ask("", **{**comes, "Sec_Fetch_Dest": "iframe"}).status == 403
    assert client.ask("", **comes, Origin="http://evil.example").status == 403


def test_the_door_leads_to_the_page_once(tmp_path: Path) -> None:
    """A browser is started with it, and all users of the machine can list what commands are given."""
    with serving(tmp_path) as one:
        door, token = one.server.door.path, one.server.guard.token
        assert token not in door
        assert one.raw(f"{door}x").status == 403
        assert one.raw(door, Host="evil.example").status == 403
        led = one.raw(door)
        assert led.status == 303
        assert led.headers["Location"] == f"/{token}/"
        for path in (door, "/open/"):
            again = one.raw(path)
            assert again.status == 403
            assert "works once" in again.error
            assert "Location" not in again.headers


def test_a_question_without_the_pages_own_header_is_refused(client: Client) -> None:
    """A form of another site can send anything but a header."""
    got = client.ask("twin/preset", {"name": "hall-12bit"}, X_Halltwin_Lab="")
    assert got.status == 403
    assert client.ask("start").json["twin"]["name"] == "imc-14bit"


OUTSIDE = (
    *("../lab.html", "page/lab.html", "..%2f..%2fpyproject.toml", "/etc/passwd", "lab.css/", "lab.css?x", "C:/"),
    *("%00", ".", "start/"),
)


@pytest.mark.parametrize("path", OUTSIDE)
def test_no_name_from_outside_becomes_a_path(client: Client, path: str) -> None:
    got = client.ask(path)
    assert got.status == 404
    assert "nothing of this name" in got.error


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "HEAD", "TRACE", "CONNECT"])
def test_other_methods_are_refused(client: Client, method: str) -> None:
    """A browser asks by OPTIONS whether another site may send the page's own header."""
    got = client.ask("start", method=method)
    assert got.status == 501
    assert "Access-Control-Allow-Origin" not in got.headers


def test_the_policy_lets_the_page_load_nothing_from_elsewhere(client: Client) -> None:
    for got in (client.ask(""), client.ask("start"), client.raw("/")):
        policy = got.headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy
        assert "unsafe" not in policy
        assert "frame-ancestors 'none'" in policy
        assert got.headers["Referrer-Policy"] == "no-referrer"
        assert got.headers["Cache-Control"] == "no-store"
        assert "Set-Cookie" not in got.headers


def test_it_listens_on_this_machine_alone(client: Client) -> None:
    assert client.server.server_address[0] == ADDRESS == "127.0.0.1"


@pytest.mark.parametrize("length", ["", "-1", "1e3", "9" * 400, str(served.LARGEST_QUESTION_BYTES + 1)])
def test_a_question_that_is_too_long_or_says_no_length_is_refused(client: Client, length: str) -> None:
    got = client.ask("design/map", body=b"{}", Content_Length=length)
    assert got.status in (411, 413)
    assert got.headers["Connection"] == "close"


def test_a_file_that_is_too_large_is_refused_before_it_is_read(client: Client) -> None:
    size = str(served.LARGEST_UPLOAD_BYTES + 1)
    got = client.ask("twin/open", body=b"x", Content_Length=size, X_File_Name="a.toml")
    assert got.status == 413
    assert "300 MB" in got.error


@pytest.mark.parametrize(
    "body", [b"", b"{", b"nan", b'{"name": NaN}', b"\xff", b"[" * 90_000, b'{"name": "hall-12bit"']
)
def test_a_question_that_is_no_json_is_one_line(client: Client, body: bytes) -> None:
    got = client.ask("twin/preset", body=body)
    assert got.status == 400
    assert "JSON" in got.error


def test_who_hangs_up_half_way_does_no_harm(client: Client) -> None:
    guard = client.server.guard
    head = f"POST /{guard.token}/twin/open HTTP/1.1\r\nHost: {ADDRESS}:{guard.port}\r\nX-Halltwin-Lab: 1\r\n"
    with socket.create_connection((ADDRESS, guard.port)) as line:
        line.sendall(f"{head}X-File-Name: a.toml\r\nContent-Length: 1000\r\n\r\nschema".encode())
    assert client.ask("start").json["twin"]["name"] == "imc-14bit"


HOSTILE = (
    *("../twin.toml", "/etc/x.toml", "a/b.toml", "..\\twin.toml", "C:x.toml", ".toml", "-x.toml", "a\nb.toml"),
    *("\u202ex.toml", "", "x" * 200 + ".toml", "a\0.toml", "twin.csv", "twin"),
)


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_name_of_a_file_is_refused(client: Client, name: str) -> None:
    body = b'schema = "halltwin.twin/1"\n[magnet]\n'
    got = client.ask("twin/open", body=body, X_File_Name=quote(name, safe=""))
    assert got.status == 400
    assert got.error.isprintable()
    assert client.ask("start").json["twin"]["name"] == "imc-14bit"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"", "schema is None"),
        (b"schema = ", "is no TOML"),
        (b"\xff\xfe", "is no TOML"),
        (b'schema = "halltwin.twin/1"\n[effects.<script>]\n', "is no TOML"),
        (b'schema = "halltwin.twin/1"\n[effects."<b>"]\nx = 1\n', "no effect named '<b>'"),
        (b'schema = "halltwin.twin/1"\n[magnet]\ndiameter_mm = nan\n', "diameter_mm is nan"),
        (b"a = " + b"[" * 5000, "too deep"),
    ],
)
def test_a_hostile_twin_is_one_line_that_names_it(client: Client, text: bytes, said: str) -> None:
    got = client.ask("twin/open", body=text, X_File_Name="my%20twin.toml")
    assert got.status == 400
    assert "my twin.toml" in got.error
    assert said in got.error


def test_an_answer_comes_in_one_piece(client: Client) -> None:
    """Head and content: a browser that gets them apart is woken twice, and the hand waits."""
    guard = client.server.guard
    with socket.create_connection((ADDRESS, guard.port)) as line:
        line.sendall(f"GET /{guard.token}/icon.svg HTTP/1.1\r\nHost: {ADDRESS}:{guard.port}\r\n\r\n".encode())
        head, _, content = line.recv(1 << 20).partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 200")
    assert content == client.ask("icon.svg").content
