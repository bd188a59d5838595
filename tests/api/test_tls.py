"""The HTTPS address on loopback: its certificate, its handshakes, and requests over it."""

import asyncio
import contextlib
import socket
import ssl
import stat
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from datetime import UTC, datetime, timedelta
from hashlib import sha256
from pathlib import Path

import httpx
import pytest
import websockets
from cryptography import x509
from tests.api.fake_station import FakeStation, application
from tests.api.serving import PATIENCE_S, connected, until_closed
from tests.patient_loop import run_patiently
from tests.persons import TOKEN, user

from recon.api import connections, servers
from recon.api.certificate import Certificate, load_certificate, own_certificate
from recon.api.login import Login
from recon.api.security import Access
from recon.api.servers import HandshakePace
from recon.model.errors import RecordError
from recon.station.host.http_servers import network_server

NOW = datetime.now(UTC)
HEADERS = {"Authorization": f"Bearer {TOKEN}"}


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Certificate:
    return own_certificate(tmp_path_factory.mktemp("tls"), ["127.0.0.1"], NOW)


@asynccontextmanager
async def served(certificate: Certificate) -> AsyncIterator[str]:
    """Serve as at the network's address, on loopback; yield the address."""
    sock = socket.create_server(("127.0.0.1", 0))
    app = application(FakeStation(), access=Access())
    server = network_server(app.app, Login([user()]), certificate)
    task = asyncio.create_task(server.serve(sockets=[sock]))
    try:
        yield f"https://127.0.0.1:{sock.getsockname()[1]}"
    finally:
        server.should_exit = True
        await task
        sock.close()


def trusting() -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return context


def test_requests_and_streams_work_with_a_token_only(certificate: Certificate) -> None:
    async def main() -> None:
        async with asyncio.timeout(PATIENCE_S), served(certificate) as url:
            async with httpx.AsyncClient(verify=trusting()) as client:
                assert (await client.get(f"{url}/api/state")).status_code == 401
                answer = await client.post(f"{url}/api/all-stop", headers=HEADERS)
                assert answer.json() == {"results": []}
                for _ in range(3):
                    assert (await client.get(f"{url}/api/state", headers=HEADERS)).is_success
            stream = url.replace("https", "wss") + "/api/stream"
            async with websockets.connect(
                stream, ssl=trusting(), additional_headers=HEADERS
            ) as reader:
                for _ in range(3):
                    assert '"time_ns"' in str(await reader.recv())

    run_patiently(main())


def test_the_audit_names_the_connections_address_not_a_headers(certificate: Certificate) -> None:
    async def main() -> None:
        async with asyncio.timeout(PATIENCE_S), served(certificate) as url:
            async with httpx.AsyncClient(verify=trusting()) as client:
                forged = {**HEADERS, "X-Forwarded-For": "203.0.113.5"}
                await client.post(f"{url}/api/all-stop", headers=forged)
                state = (await client.get(f"{url}/api/state", headers=HEADERS)).json()
            assert state["stop_latch"]["by"] == "cleo (127.0.0.1)"

    run_patiently(main())


def test_plain_http_and_old_tls_get_nothing(certificate: Certificate) -> None:
    async def main() -> None:
        async with asyncio.timeout(PATIENCE_S), served(certificate) as url:
            peer = await connected(url)
            loop = asyncio.get_running_loop()
            await loop.sock_sendall(peer, b"GET / HTTP/1.1\r\nHost: x\r\n\r\n")
            await until_closed(peer)
            old = trusting()
            with pytest.warns(DeprecationWarning, match="deprecated"):
                old.minimum_version = ssl.TLSVersion.TLSv1
            with pytest.warns(DeprecationWarning, match="deprecated"):
                old.maximum_version = ssl.TLSVersion.TLSv1_1
            old.set_ciphers("ALL:@SECLEVEL=0")
            async with httpx.AsyncClient(verify=old) as client:
                with pytest.raises(httpx.ConnectError):
                    await client.get(url)

    run_patiently(main())


def test_half_a_handshake_loses_its_place(
    certificate: Certificate, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "PATIENCE_S", 0.3)

    async def main() -> None:
        async with asyncio.timeout(PATIENCE_S), served(certificate) as url:
            peers = [await connected(url) for _ in range(30)]
            for peer in peers[::2]:
                await asyncio.get_running_loop().sock_sendall(peer, b"\x16\x03\x01\x02\x00\x01")
            await asyncio.gather(*(until_closed(peer) for peer in peers))

    run_patiently(main())


def test_half_handshakes_count_among_those_that_wait(
    certificate: Certificate, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "PATIENCE_S", 60.0)
    monkeypatch.setattr(connections, "MAX_WAITING", 4)

    async def main() -> None:
        async with asyncio.timeout(PATIENCE_S), served(certificate) as url:
            peers = [await connected(url) for _ in range(5)]
            await until_closed(peers[0])
            async with httpx.AsyncClient(verify=trusting()) as client:
                assert (await client.get(f"{url}/api/state", headers=HEADERS)).is_success
            assert not connections.HttpConnection.waiting
            for peer in peers[1:]:
                peer.close()

    run_patiently(main())


def test_handshakes_begin_at_a_limited_rate() -> None:
    pace, now_s = HandshakePace(), 1000.0
    assert [pace.wait_s(now_s) for _ in range(servers.BURST)] == [0.0] * servers.BURST
    for _ in range(100):
        now_s += pace.wait_s(now_s)
    assert now_s == pytest.approx(1000.0 + 100 / servers.HANDSHAKES_HZ)
    assert pace.wait_s(now_s + 60.0) == 0.0


class TestCertificate:
    def test_it_is_kept_for_its_owner_and_used_again(self, tmp_path: Path) -> None:
        first = own_certificate(tmp_path / "https", ["192.0.2.5", "field.example"], NOW)
        again = own_certificate(tmp_path / "https", ["192.0.2.6"], NOW + timedelta(days=700))
        assert again.fingerprint == first.fingerprint
        for path in (tmp_path / "https").iterdir():
            assert stat.S_IMODE(path.stat().st_mode) == 0o600

    def test_its_fingerprint_and_names(self, tmp_path: Path) -> None:
        made = own_certificate(tmp_path, ["192.0.2.5", "2001:db8::1", "field.example"], NOW)
        loaded = x509.load_pem_x509_certificate((tmp_path / "certificate.pem").read_bytes())
        der = ssl.PEM_cert_to_DER_cert((tmp_path / "certificate.pem").read_text())
        assert made.fingerprint.replace(":", "").lower() == sha256(der).hexdigest()
        names = loaded.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
        addresses = {str(each) for each in names.get_values_for_type(x509.IPAddress)}
        assert {"192.0.2.5", "2001:db8::1", "127.0.0.1", "::1"} <= addresses
        hosts = names.get_values_for_type(x509.DNSName)
        assert {"field.example", socket.gethostname(), "localhost"} <= set(hosts)
        basic = loaded.extensions.get_extension_for_class(x509.BasicConstraints).value
        assert not basic.ca

    def test_it_is_renewed_before_its_end(self, tmp_path: Path) -> None:
        first = own_certificate(tmp_path, [], NOW)
        later = own_certificate(tmp_path, [], NOW + timedelta(days=775))
        assert later.fingerprint != first.fingerprint

    @pytest.mark.parametrize("name", ["certificate.pem", "key.pem"])
    @pytest.mark.parametrize("content", [None, b"", b"\xff noise"])
    def test_a_damaged_one_is_replaced(
        self, name: str, content: bytes | None, tmp_path: Path
    ) -> None:
        first = own_certificate(tmp_path, [], NOW)
        with contextlib.suppress(FileNotFoundError):
            (tmp_path / name).unlink()
        if content is not None:
            (tmp_path / name).write_bytes(content)
        assert own_certificate(tmp_path, [], NOW).fingerprint != first.fingerprint

    def test_a_sites_own_that_cannot_be_used_is_one_sentence(self, tmp_path: Path) -> None:
        own_certificate(tmp_path / "a", [], NOW)
        own_certificate(tmp_path / "b", [], NOW)
        certificate, other = tmp_path / "a" / "certificate.pem", tmp_path / "b" / "key.pem"
        for key in (other, tmp_path / "none.pem", tmp_path):
            with pytest.raises(RecordError, match="belong together"):
                load_certificate(certificate, key)

    def test_a_key_with_a_password_does_not_ask_for_it(self, tmp_path: Path) -> None:
        from cryptography.hazmat.primitives import serialization

        own_certificate(tmp_path, [], NOW)
        key = serialization.load_pem_private_key((tmp_path / "key.pem").read_bytes(), None)
        (tmp_path / "locked.pem").write_bytes(
            key.private_bytes(
                serialization.Encoding.PEM,
                serialization.PrivateFormat.PKCS8,
                serialization.BestAvailableEncryption(b"secret"),
            )
        )
        with pytest.raises(RecordError, match="without a password"):
            load_certificate(tmp_path / "certificate.pem", tmp_path / "locked.pem")
