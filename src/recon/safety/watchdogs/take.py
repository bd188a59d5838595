"""The picture taken: from vehicles' states to what all watchdogs look at."""

from collections.abc import Iterable, Mapping

from recon.model.geo import LatLon
from recon.model.intent import Commanded, Intent
from recon.model.units import NS_PER_S
from recon.model.vehicle import VehicleState
from recon.safety.airspace import PreparedAirspace
from recon.safety.prediction import Follower, Plane, flyer, hazard_area_of
from recon.safety.prediction.course import CURVE, RADIUS_0, RADIUS_1, Row
from recon.safety.settings import SafetySettings
from recon.safety.watchdogs.ahead import Braking, look_ahead, next_rows
from recon.safety.watchdogs.picture import Picture, WatchedVehicle


def take_picture(
    vehicles: Iterable[WatchedVehicle],
    airspace: PreparedAirspace,
    settings: SafetySettings,
    now_ns: int,
    since_ns: Mapping[str, int],
    *,
    is_hold_on: bool = True,
) -> Picture:
    """Return the picture of vehicles that fly or may; those on the ground must not be among them.

    Their flyers and hazard areas are worked out here.
    """
    known = tuple(vehicles)
    plane = plane_of(airspace, (one.state for one in known))
    watched = tuple(_placed(one, airspace, settings, plane, now_ns) for one in known)
    flying = tuple(one for one in watched if one.is_heard_flying)
    unseen = tuple(one for one in watched if one.may_fly_on_unseen)
    rows = [_next_rows(one, settings, now_ns) for one in flying]
    rows += [_rows_unseen(one, settings) for one in unseen]
    return Picture(
        now_ns=now_ns,
        watched=watched,
        flying=flying,
        unseen=unseen,
        ahead=look_ahead(rows, settings.watch, settings.prediction),
        airspace=airspace,
        settings=settings.watch,
        prediction=settings.prediction,
        energy=settings.energy,
        since_ns=since_ns,
        is_hold_on=is_hold_on,
    )


def plane_of(airspace: PreparedAirspace, states: Iterable[VehicleState]) -> Plane:
    """Return the plane at the site's origin; without a site, at the first vehicle that has a place.

    Where no vehicle has one, it lies anywhere.
    """
    frame = airspace.airspace.frame
    if frame is not None:
        return Plane(frame.origin)
    places = (state.position.value for state in states)
    first = next((place for place in places if place is not None), None)
    return Plane(first or LatLon(0.0, 0.0))


def _placed(
    one: WatchedVehicle,
    airspace: PreparedAirspace,
    settings: SafetySettings,
    plane: Plane,
    now_ns: int,
) -> WatchedVehicle:
    seen = flyer(one.state, airspace, plane, now_ns, settings.prediction)
    hazard = None if seen is None else hazard_area_of(seen, one.intent, settings.prediction)
    # Written out, for `replace` takes longer than all the rest.
    return WatchedVehicle(
        one.state,
        one.intent,
        one.holder,
        seen,
        hazard,
        one.held,
        one.before,
        one.is_imager,
        one.stick_quiet_s,
        one.hold_refused,
    )


def _next_rows(one: WatchedVehicle, settings: SafetySettings, now_ns: int) -> list[Row]:
    """A hold that the station gave counts from its giving on, until a newer order."""
    assert one.flyer is not None, "a vehicle that is heard flying has told where it is"
    intent, braking, held = one.intent, None, one.held
    if held is not None and held.holds_against(intent):
        if not one.is_coming_down:
            intent = Intent(Commanded.HOLD, held.since_ns)
        braking = Braking((now_ns - held.since_ns) / NS_PER_S, held.speed_mps)
    horizon_s = settings.watch.horizon_s
    return next_rows(one.flyer, intent, braking, horizon_s, now_ns, settings.prediction)


def _rows_unseen(one: WatchedVehicle, settings: SafetySettings) -> list[Row]:
    """The mission it was sent, flown on: anywhere within what time has made of its place."""
    flyer, prediction = one.flyer, settings.prediction
    assert flyer is not None, "only a vehicle that has told where it is has a hazard area"
    follower = Follower(flyer, prediction, until_s=settings.watch.horizon_s)
    follower.follow(one.intent)
    off_m = prediction.time_uncertainty * flyer.age_s * flyer.speed_mps
    return [
        (*row[:RADIUS_0], row[RADIUS_0] + off_m, row[RADIUS_1] + off_m, *row[CURVE:])
        for row in follower.writer.rows
    ]
