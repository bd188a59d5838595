"""Errors between a program and the station. A refused order is a value, not an error.

ClientError                  the text states what was expected, what was received, and what to do
|- AddressError              an invalid address or token
|- StationUnreachableError   no connection: nothing was sent
|  |- CertificateError       the certificate is not the pinned one, or of no known authority
|- RequestRefusedError       the station answered and did nothing
|  |- OrderInvalidError      the order's format was rejected (returned as a `Refusal`)
|- BadAnswerError            the response is not a station's
|- MaybeSentError            an order was sent without a valid answer: it may be flown
|- ConnectionLostError       the stream of states is lost: known values are old
|- WaitTimeoutError          an awaited state did not occur in time
"""

from recon.model.errors import ReconError


class ClientError(ReconError):
    """Base class of the client's errors."""


class AddressError(ClientError):
    """An invalid address or token; nothing was sent."""


class StationUnreachableError(ClientError):
    """No connection to the station was made; nothing was sent."""

    is_failure = True


class CertificateError(StationUnreachableError):
    """The station's certificate is not the pinned one, or no known authority vouches for it."""


class RequestRefusedError(ClientError):
    """The station rejected the request (token, host name, version); nothing was executed."""

    is_failure = True


LOGIN_ADVICE = "in the shell by --token-file FILE, in Python by `token`"
"""How a program logs in: after the station's own sentence about a missing or wrong token."""


class OrderInvalidError(RequestRefusedError):
    """The station rejected the order's format; the client returns this as a `Refusal`."""


class BadAnswerError(ClientError):
    """The response is not JSON, has an unexpected structure, or is too long."""

    is_failure = True


class MaybeSentError(ClientError):
    """An order was sent without a valid answer and may be executed.

    The client never repeats it. Check the vehicle before sending it again.
    """

    is_failure = True


class ConnectionLostError(ClientError):
    """The stream of states is lost, or the station has restarted."""

    is_failure = True


class WaitTimeoutError(ClientError):
    """A vehicle did not connect, or an order did not reach a phase, in the given time."""

    is_failure = True
