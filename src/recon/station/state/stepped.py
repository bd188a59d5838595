"""What every step of the station returns, and how a step asks the gate about one command."""

from collections.abc import Callable

from recon.model.command import Command, Refusal
from recon.safety import ApprovedCommand
from recon.station.state.outputs import Output
from recon.station.state.station import Station

Stepped = tuple[Station, tuple[Output, ...]]
"""The station after a step, and what the drivers are to do."""

Judge = Callable[[Station, Command], ApprovedCommand | Refusal]
"""The gate's verdict on one command in a station's state."""
