"""A flight record, opened for a command."""

from pathlib import Path

from recon.cli.output import print_warning
from recon.cli.progress import opener
from recon.model.errors import RecordError
from recon.product.flight import FlightData
from recon.product.flight_reader import read_flight


def opened_flight(path: Path) -> FlightData:
    """Return a record's flight, with a warning if it ends early; raises `RecordError`."""
    try:
        flight = read_flight(path, opener("reading the flight"))
    except OSError as problem:
        raise RecordError(f"{path}: {problem.strerror}") from problem
    if flight.trouble:
        print_warning(f"the record ends early: {flight.trouble}")
    return flight
