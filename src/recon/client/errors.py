"""What can go wrong between a program and the station. A refused order is no error but a value.

ClientError                  its text says what was expected, what came, and what to do
|- AddressError              an address or a token that cannot be one
|- StationUnreachableError   no connection was made: nothing was sent
|- RequestRefusedError       the station answered, and did not do what was asked
|  |- OrderInvalidError      it did not take the order's form (seen as a `Refusal`)
|- BadAnswerError            what came is not what a station says
|- MaybeSentError            an order left, and no usable answer came: it may be flown
|- ConnectionLostError       the stream of states broke off: what is known grows old
|- TookTooLongError          what was waited for did not come in time
"""

from recon.model.errors import ReconError


class ClientError(ReconError):
    """The root of the client's errors."""


class AddressError(ClientError):
    """An address or a token that cannot be one; nothing was sent."""


class StationUnreachableError(ClientError):
    """No connection to the station was made; nothing was sent."""


class RequestRefusedError(ClientError):
    """The station answered that it does not do this (token, host name, version); nothing flew."""


class OrderInvalidError(RequestRefusedError):
    """The station did not take the order's form; it becomes a refusal, as a value."""


class BadAnswerError(ClientError):
    """What came is not JSON, not of the expected shape, or too long."""


class MaybeSentError(ClientError):
    """An order may have been carried out: it left, and no usable answer came.

    The client never gives it again by itself. See what the vehicle does, then decide.
    """


class ConnectionLostError(ClientError):
    """The stream of states broke off, or another run of the station answers now."""


class TookTooLongError(ClientError):
    """A vehicle did not connect, or an order did not get so far, within the given time."""
