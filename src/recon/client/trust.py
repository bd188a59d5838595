"""Trust in a station's certificate: by its pinned fingerprint, or by this computer's authorities.

A station at a field has a self-signed certificate. Its fingerprint, which the station prints, is
pinned: the certificate is fetched once, compared, and then the only one that connections accept.
"""

import asyncio
import ssl
from hashlib import sha256
from urllib.parse import urlsplit

from recon.client.address import Address
from recon.client.errors import CertificateError

ANSWER_WITHIN_S = 5.0


class CertificateTrust:
    """The TLS settings for one station; `prepare` must end before the first connection."""

    def __init__(self, address: Address) -> None:
        self._address = address
        self._is_ready = not address.is_secure or address.fingerprint is None
        self.context = _context(address)

    async def prepare(self) -> None:
        """Compare the certificate with the pinned one, once; raises `CertificateError`, OSError."""
        if self._is_ready:
            return
        der = await self._fetched()
        found = sha256(der).hexdigest()
        if found != self._address.fingerprint:
            raise CertificateError(
                f"expected the certificate {shown(self._address.fingerprint or '')} at "
                f"{self._address.http}, got {shown(found)}; nothing was sent: another computer "
                "answers there, or the station has a new certificate; compare it with what the "
                "station prints at its start"
            )
        self.context.load_verify_locations(cadata=der)
        self._is_ready = True

    def untrusted(self) -> CertificateError:
        """Return the error of a certificate that no authority vouches for."""
        return CertificateError(
            f"the certificate of {self._address.http} is not of an authority that this computer "
            "trusts; nothing was sent: give the fingerprint that the station prints at its start, "
            "with RECON_FINGERPRINT or as #fingerprint=... at the end of the address"
        )

    async def _fetched(self) -> bytes:
        place = urlsplit(self._address.http)
        anyone = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        anyone.check_hostname = False
        anyone.verify_mode = ssl.CERT_NONE
        async with asyncio.timeout(ANSWER_WITHIN_S):
            _, writer = await asyncio.open_connection(
                place.hostname, place.port or 443, ssl=anyone, server_hostname=""
            )
            der = writer.get_extra_info("ssl_object").getpeercert(binary_form=True)
            # The handshake is done; the station needs no orderly end.
            writer.transport.abort()
        return bytes(der)


def is_untrusted(problem: BaseException) -> bool:
    """Return whether a connection failed because of its certificate."""
    return "CERTIFICATE_VERIFY_FAILED" in str(problem)


def shown(fingerprint: str) -> str:
    """Return a fingerprint as browsers and the station show it."""
    return ":".join(fingerprint[i : i + 2] for i in range(0, len(fingerprint), 2)).upper()


def _context(address: Address) -> ssl.SSLContext:
    if address.is_secure and address.fingerprint is None:
        return ssl.create_default_context()
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    # The fingerprint names one certificate, under whatever address the station has today.
    context.check_hostname = False
    context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
    return context
