"""Orders as a console gives them, and waiting for what telemetry shows."""

from tests.android.processes import until

from recon.client import Mission, Order, Phase, Refusal, Station, Vehicle, Waypoint

PATIENCE_S = 90.0


def accepted(answer: Order | Refusal) -> Order:
    """Return the order, which the station must have accepted."""
    assert isinstance(answer, Order), answer
    return answer


async def finish(answer: Order | Refusal, phase: Phase = Phase.DONE) -> None:
    """Wait until an order has reached a phase; it must not end otherwise."""
    status = await accepted(answer).wait(phase, timeout_s=PATIENCE_S)
    assert status.phase in (phase, Phase.DONE), status


async def vehicle(station: Station, serial: str = "SIM-1") -> Vehicle:
    """Return a vehicle with live telemetry, for which its checklist need not be passed."""
    found = await station.vehicle(serial, timeout_s=PATIENCE_S)
    await until(
        lambda: found.now().is_live and found.now().position.latitude_deg is not None, "live"
    )
    return found


def leg(vehicle: Vehicle, north_m: float = 60.0, height_m: float = 12.0) -> Mission:
    """Return a mission from the vehicle's position north, at 4 m/s."""
    place = vehicle.now().position
    assert place.latitude_deg is not None
    assert place.longitude_deg is not None
    return Mission(
        tuple(
            Waypoint(place.latitude_deg + metres / 111_100.0, place.longitude_deg, height_m, 4.0)
            for metres in (0.0, north_m)
        )
    )


def speed_mps(vehicle: Vehicle) -> float:
    """Return the horizontal speed that telemetry shows."""
    velocity = vehicle.now().velocity_ned
    return float(((velocity.north_mps or 0.0) ** 2 + (velocity.east_mps or 0.0) ** 2) ** 0.5)
