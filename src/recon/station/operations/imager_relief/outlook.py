"""What is predicted once a second: when each imaging drone must return, what each survey needs."""

from collections.abc import Mapping
from dataclasses import replace

from recon.guidance.imager_relief import (
    RELIEF_SETTINGS,
    ImagerReliefSettings,
    MissingGround,
    return_due_ns,
    survey_needs_s,
    use_per_s,
    with_charge,
    with_missing,
)
from recon.guidance.survey import SurveyState, figures
from recon.guidance.survey.settings import DEFAULT as SURVEY_DEFAULT
from recon.model.survey import CellState, planner_goal
from recon.model.units import ns_to_seconds, seconds_to_ns
from recon.model.vehicle import BatteryWarning, VehicleState
from recon.safety.datum import takeoff_up_m
from recon.safety.energy import consumption, fraction_to_get_home
from recon.station.imaging.at_work import imagers_at_work
from recon.station.imaging.upwind import LEAST_HEIGHT_M
from recon.station.operations.imager_motion.claim import RESTING_MPS, is_at_rest
from recon.station.state.imager_relief import (
    HoverPlace,
    ImagerOutlook,
    Reliefs,
    SurveyOutlook,
    WithoutLight,
)
from recon.station.state.station import Station
from recon.station.state.survey_record import SurveyRecord

RESOLUTION = 0.01
"""Resolution of a charge: reports are in whole percent, so it may be less by this."""

PACE_EVERY_S = 10.0
"""Interval between two samples of a survey's pace: counting cells takes 0.1 ms."""


def on_position(station: Station, vehicle: VehicleState, now_ns: int) -> Station:
    """Keep the changes of an imaging drone's charge in the air."""
    serial, charge = vehicle.serial or "", vehicle.battery_fraction.value
    if serial not in station.imaging.imagers or charge is None:
        return station
    reliefs = station.reliefs
    before = reliefs.charges.get(serial, ())
    is_up = vehicle.is_flying.value is True
    after = with_charge(before, now_ns, charge) if is_up else ()
    if after == before:
        return station
    return replace(station, reliefs=replace(reliefs, charges={**reliefs.charges, serial: after}))


def checked(
    station: Station, now_ns: int, settings: ImagerReliefSettings = RELIEF_SETTINGS
) -> tuple[Station, bool]:
    """Return the station with its outlooks of now, and whether they were due."""
    reliefs = station.reliefs
    since_ns = reliefs.checked_at_ns
    if not station.imaging.imagers or (
        since_ns is not None and now_ns - since_ns < seconds_to_ns(settings.checked_every_s)
    ):
        return station, False
    reliefs = replace(
        reliefs,
        checked_at_ns=now_ns,
        places=_places(station, now_ns),
        outlooks={each: imager_outlook(station, each, now_ns) for each in imagers_at_work(station)},
        surveys={
            number: _survey_outlook(station, record, now_ns)
            for number, record in station.surveys.records.items()
            if record.is_running
        },
    )
    return replace(station, reliefs=reliefs), True


def imager_outlook(station: Station, serial: str, now_ns: int) -> ImagerOutlook:
    """Return when an imaging drone in the air must return, by its reports.

    Its charge then is what the route home and the site's reserve take, or the charge at which the
    failsafe matrix recalls it, whichever is more; and a minute beside, as survey vehicles keep:
    its route home may wait for others' rows.
    """
    vehicle, energy = station.fleet.vehicles[serial], station.settings.safety.energy
    if vehicle.battery_warning.value in (BatteryWarning.LOW, BatteryWarning.SERIOUS):
        return ImagerOutlook(now_ns)
    charges = station.reliefs.charges.get(serial, ())
    if not charges:
        return ImagerOutlook(None, unknown="battery charge unknown: check its companion app")
    uses = consumption(vehicle, station.airspace, energy)
    if uses is None:
        why = "endurance unknown: write endurance_min under its [[vehicles]] in site.toml"
        return ImagerOutlook(None, unknown=why)
    home = fraction_to_get_home(vehicle, station.airspace, energy)
    if home is None:
        return ImagerOutlook(None, unknown="position or home unknown: confirm them with its pilot")
    reserve = station.airspace.airspace.limits.battery_reserve_fraction
    use = use_per_s(charges) or uses.fraction(1.0)
    needed = max(home + reserve, station.settings.low_battery_fraction) + RESOLUTION
    needed += use * SURVEY_DEFAULT.route_home_waits_s
    at_ns = return_due_ns(charges[-1], use, needed)
    return ImagerOutlook(at_ns, ns_to_seconds(at_ns - now_ns))


def _places(station: Station, now_ns: int) -> Mapping[str, HoverPlace]:
    """Where each imaging drone hovers now, or did last; not beside its place to side-step."""
    places, motion = dict(station.reliefs.places), station.imager_motions.under_way()
    for serial in imagers_at_work(station):
        vehicle = station.fleet.vehicles[serial]
        place, velocity = vehicle.position.value, vehicle.velocity_ned.value
        height_m = vehicle.height_above_takeoff_m.value
        base_m = takeoff_up_m(station.airspace, vehicle)
        if place is None or velocity is None or height_m is None or base_m is None:
            continue
        is_still = velocity.speed_mps < RESTING_MPS and height_m >= LEAST_HEIGHT_M
        is_moving = motion is not None and motion.serial == serial
        if is_still and not is_moving and is_at_rest(station, vehicle):
            places[serial] = HoverPlace(place, base_m + height_m, now_ns)
    return places


def _survey_outlook(station: Station, record: SurveyRecord, now_ns: int) -> SurveyOutlook:
    before = station.reliefs.surveys.get(record.survey.id, SurveyOutlook())
    state = record.state
    assert state is not None, "a running survey has rows"
    missing = before.missing
    if not missing or now_ns - missing[-1].at_ns >= seconds_to_ns(PACE_EVERY_S):
        missing_m2 = state.plan.cells.area_m2(state.missing())
        missing = with_missing(missing, MissingGround(now_ns, missing_m2))
    return SurveyOutlook(
        missing, survey_needs_s(missing, now_ns), _without_light(station, state, before, now_ns)
    )


def _without_light(
    station: Station, state: SurveyState, before: SurveyOutlook, now_ns: int
) -> WithoutLight | None:
    """Return since when it has had no shade map; None if it never had one."""
    newest = station.shade.shade
    goal = planner_goal(state.plan.survey.planner)
    if newest is None or goal is not CellState.IN_SUN:
        return None
    if now_ns - newest.captured_at_ns <= seconds_to_ns(SURVEY_DEFAULT.forecast_age_s):
        return None
    return before.without_light or WithoutLight(
        newest.captured_at_ns, figures(state).sun_unknown_m2
    )


def needs_longer(reliefs: Reliefs, survey_id: int, return_due_in_s: float) -> bool:
    """Return whether a survey is not done when an imaging drone leaves, or may not be."""
    outlook = reliefs.surveys.get(survey_id)
    needs_s = None if outlook is None else outlook.needs_s
    return needs_s is None or needs_s > return_due_in_s
