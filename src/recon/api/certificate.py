"""The certificate of the HTTPS address: the site's own, or one that the station generates.

A generated one is self-signed: no authority vouches for a laptop at a field. What others compare is
its fingerprint, so it is kept and used again, also under another address of the computer, until a
month before its end. It cannot sign other certificates.
"""

import contextlib
import os
import socket
import ssl
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from hashlib import sha256
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING

from recon.model.errors import RecordError

if TYPE_CHECKING:
    from cryptography import x509

CERTIFICATE_NAME = "certificate.pem"
KEY_NAME = "key.pem"

VALID_FOR = timedelta(days=800)
"""Apple's devices accept at most 825 days."""
RENEWED_BEFORE = timedelta(days=30)


@dataclass(frozen=True, slots=True)
class Certificate:
    """A server's TLS settings, and the SHA-256 of its certificate."""

    context: ssl.SSLContext
    fingerprint: str
    """Fingerprint as browsers show it: AB:CD:..."""


def load_certificate(certificate: Path, key: Path) -> Certificate:
    """Return the TLS settings of a certificate and its key; raises `RecordError`."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(certificate, key, password=_no_password)
        pem = certificate.read_text(encoding="ascii")
        end = "-----END CERTIFICATE-----"
        der = ssl.PEM_cert_to_DER_cert(pem[pem.index("-----BEGIN CERT") : pem.index(end)] + end)
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem)
        raise RecordError(
            f"cannot use the certificate {certificate} with the key {key}: {reason}; expected PEM "
            "files that belong together, the key without a password"
        ) from problem
    return Certificate(context, fingerprint_of(der))


def fingerprint_of(der: bytes) -> str:
    """Return the SHA-256 of a certificate as browsers show it."""
    return sha256(der).digest().hex(":").upper()


def own_certificate(folder: Path, addresses: Sequence[str], now: datetime) -> Certificate:
    """Return the station's generated certificate, a new one if needed; raises `RecordError`."""
    certificate, key = folder / CERTIFICATE_NAME, folder / KEY_NAME
    if not _is_usable(certificate, key, now):
        try:
            _generate(certificate, key, addresses, now)
        except OSError as problem:
            raise RecordError(f"cannot write a certificate to {folder}: {problem}") from problem
    return load_certificate(certificate, key)


def _no_password() -> str:
    # Without this OpenSSL asks on the terminal, and the station waits.
    raise ValueError("the key is encrypted")


def _is_usable(certificate: Path, key: Path, now: datetime) -> bool:
    from cryptography import x509

    try:
        loaded = x509.load_pem_x509_certificate(certificate.read_bytes())
        load_certificate(certificate, key)
    except (OSError, ValueError, RecordError):
        return False
    return loaded.not_valid_before_utc <= now < loaded.not_valid_after_utc - RENEWED_BEFORE


def _generate(certificate: Path, key: Path, addresses: Sequence[str], now: datetime) -> None:
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

    private = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name(
        [x509.NameAttribute(NameOID.COMMON_NAME, f"Recon {socket.gethostname()}"[:64])]
    )
    made = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(private.public_key())
        .serial_number(x509.random_serial_number())
        # An hour back, for tablets whose clock is behind.
        .not_valid_before(now - timedelta(hours=1))
        .not_valid_after(now + VALID_FOR)
        .add_extension(x509.SubjectAlternativeName(_names(addresses)), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .sign(private, hashes.SHA256())
    )
    certificate.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    _write(
        key,
        private.private_bytes(
            serialization.Encoding.PEM,
            serialization.PrivateFormat.PKCS8,
            serialization.NoEncryption(),
        ),
    )
    _write(certificate, made.public_bytes(serialization.Encoding.PEM))


def _names(addresses: Sequence[str]) -> list["x509.GeneralName"]:
    from cryptography import x509

    names: list[x509.GeneralName] = []
    host = socket.gethostname()
    for each in dict.fromkeys([*addresses, host, f"{host}.local", "localhost", "127.0.0.1", "::1"]):
        try:
            names.append(x509.IPAddress(ip_address(each.partition("%")[0])))
        except ValueError:
            with contextlib.suppress(ValueError):
                names.append(x509.DNSName(each))
    return names


def _write(path: Path, data: bytes) -> None:
    """Replace a file by one that its owner alone can read."""
    temporary = path.with_name(path.name + ".tmp")
    temporary.unlink(missing_ok=True)
    file = os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600)
    with os.fdopen(file, "wb") as opened:
        opened.write(data)
        opened.flush()
        os.fsync(opened.fileno())
    os.replace(temporary, path)
