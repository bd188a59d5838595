"""Errors of the gateways."""

from recon.model.errors import ReconError


class GatewayError(ReconError):
    """A gateway that cannot start: an address, a key, a missing package."""
