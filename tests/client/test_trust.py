"""The client at an https address: a pinned certificate, another one, and none pinned."""

import asyncio
from datetime import UTC, datetime
from pathlib import Path

import pytest
from tests.api.test_tls import served
from tests.patient_loop import run_patiently
from tests.persons import TOKEN

from recon.api.certificate import Certificate, own_certificate
from recon.client import AddressError, CertificateError, RequestRefusedError, Station
from recon.client.address import parse_address

PINNED = "ab" * 32


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Certificate:
    return own_certificate(tmp_path_factory.mktemp("tls"), [], datetime.now(UTC))


def test_a_pinned_certificate_is_trusted(certificate: Certificate) -> None:
    async def main() -> None:
        async with asyncio.timeout(120.0), served(certificate) as url:
            ends = f"#token={TOKEN}&fingerprint={certificate.fingerprint.replace(':', '')}"
            for station in (
                Station(url, TOKEN, fingerprint=certificate.fingerprint),
                Station(f"{url}/{ends}"),
            ):
                async with station:
                    assert station.vehicles() == ()
                    assert await station.all_stop() == ()
                    assert (await station.stop_in_force()) is not None

    run_patiently(main())


def test_another_certificate_gets_nothing(certificate: Certificate, tmp_path: Path) -> None:
    other = own_certificate(tmp_path, [], datetime.now(UTC))

    async def main() -> None:
        async with asyncio.timeout(120.0), served(other) as url:
            station = Station(url, TOKEN, fingerprint=certificate.fingerprint)
            with pytest.raises(CertificateError, match=certificate.fingerprint):
                async with station:
                    pass
            at_once = Station(url, TOKEN, fingerprint=certificate.fingerprint)
            with pytest.raises(CertificateError, match=other.fingerprint):
                await at_once.all_stop_at_once()
            await at_once.close()

    run_patiently(main())


def test_an_unpinned_one_of_no_authority_is_refused_in_a_sentence(certificate: Certificate) -> None:
    async def main() -> None:
        async with asyncio.timeout(120.0), served(certificate) as url:
            with pytest.raises(CertificateError, match="RECON_FINGERPRINT"):
                async with Station(url, TOKEN):
                    pass
            at_once = Station(url, TOKEN)
            with pytest.raises(CertificateError, match="nothing was sent"):
                await at_once.all_stop_at_once()
            await at_once.close()

    run_patiently(main())


def test_a_wrong_token_is_refused(certificate: Certificate) -> None:
    async def main() -> None:
        async with asyncio.timeout(120.0), served(certificate) as url:
            with pytest.raises(RequestRefusedError, match="token wrong"):
                async with Station(url, "wrong", fingerprint=certificate.fingerprint):
                    pass

    run_patiently(main())


@pytest.mark.parametrize("given", [PINNED, PINNED.upper(), ":".join(["AB"] * 32)])
def test_fingerprints_are_read_as_they_are_printed(given: str) -> None:
    assert parse_address("https://h:1", None, given).fingerprint == PINNED
    assert parse_address(f"https://h:1/#fingerprint={given}").fingerprint == PINNED
    assert parse_address(f"https://h:1/#token=t&fingerprint={given}").token == "t"


@pytest.mark.parametrize("given", ["ab", "x" * 64, PINNED + "00"])
def test_what_is_no_fingerprint_is_refused(given: str) -> None:
    with pytest.raises(AddressError, match="64 hexadecimal digits"):
        parse_address("https://h:1", None, given)
