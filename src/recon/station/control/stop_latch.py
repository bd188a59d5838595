"""The latch of an all stop. The only writer of `Station.stop_latch`.

Theory of operation.

    open --all stop--> latched --release of all--> open
                       latched --release of a vehicle--> latched for the others
                       latched --all stop again--> latched for every vehicle

While a vehicle is latched the gate refuses every order that moves it. What waits unsent ends with
the latch, and what guidance controls is the operator's again, so that nothing resumes by
itself at the release. Only a person latches and releases. A single hold does not latch: its
operator watches that vehicle, and the next order is as deliberate as the hold.
"""

from recon.model.command import Refusal
from recon.model.control import StopLatch
from recon.model.event import AllStopped, StopReleased
from recon.model.replacing import replace
from recon.station.control import authority
from recon.station.control.withdrawal import withdraw
from recon.station.state.station import Station
from recon.station.state.steps import Output, Stepped

RULE = "stop_latch"


def latch(station: Station, event: AllStopped, now_ns: int) -> Stepped:
    """Latch every vehicle, withdraw what waits unsent, and take them from guidance."""
    station = replace(station, stop_latch=StopLatch(event.by, now_ns))
    why = f"all stop by {event.by}"
    outputs: tuple[Output, ...] = ()
    for serial in station.fleet.vehicles:
        station, withdrawn = withdraw(station, serial, why, now_ns)
        station = authority.hand_back(station, serial, event.by, why, now_ns)
        outputs += withdrawn
    return station, outputs


def refusal(station: Station, event: StopReleased) -> Refusal | None:
    """Return why a release is refused, else None."""
    if station.stop_latch is None:
        return Refusal(RULE, "No all stop is in force; nothing to release")
    unknown = [s for s in event.serials or () if s not in station.fleet.vehicles]
    if unknown:
        names = ", ".join(unknown)
        return Refusal(RULE, f"{names}: unknown serial; nothing was released")
    return None


def release(station: Station, event: StopReleased, _now_ns: int) -> Station:
    """Release vehicles, unless that is refused. Nothing is sent; they stay as they are."""
    latched = station.stop_latch
    if latched is None or refusal(station, event) is not None:
        return station
    if event.serials is None:
        return replace(station, stop_latch=None)
    # A forgotten vehicle that returns is a new one, and latched.
    released = (latched.released & station.fleet.vehicles.keys()) | set(event.serials)
    return replace(station, stop_latch=replace(latched, released=frozenset(released)))


def restore(station: Station, restored: StopLatch | None) -> Station:
    """Return the station with the latch of the last run."""
    return replace(station, stop_latch=restored)
