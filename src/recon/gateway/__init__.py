"""Gateways: what a station shows and takes, in protocols of other programs.

A gateway is a client of the API like any other; the station knows nothing of it.
"""

from recon.gateway.errors import GatewayError
