"""What a planned survey will take with named vehicles, as they are now; nothing changes."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from recon.api import schema
from recon.guidance.survey import Surveyor, SurveyPlan
from recon.guidance.survey.estimate import (
    Batteries,
    SurveyEstimate,
    corner_of,
    estimate,
    plan_figures,
)
from recon.guidance.survey.imaging import EXPOSURE_S, speed_limits
from recon.model.command import Refusal
from recon.model.units import Stamped
from recon.model.vehicle import VehicleState
from recon.safety.datum import home_enu_m, takeoff_up_m, vehicle_enu_m
from recon.station.operations.survey.availability import time_left_s
from recon.station.state.station import Station

Preview = Callable[[], schema.SurveyEstimateView]


@dataclass(frozen=True, slots=True, eq=False)
class PreviewedFleet:
    """A planned survey with the vehicles it is previewed for, as they are now.

    `names` are theirs by serial, and of the one drone that stands in for none.
    """

    plan: SurveyPlan
    fleet: tuple[Surveyor, ...]
    names: Mapping[str, str]
    batteries: Batteries
    problem: str | None
    fastest_mps: float

    def needs(self) -> SurveyEstimate | Refusal:
        """Return what the survey takes; safe on any thread, tens of milliseconds."""
        if self.problem is not None:
            return Refusal("survey", self.problem)
        return estimate(self.plan, self.fleet, self.batteries)


def survey_preview(station: Station, plan: SurveyPlan, serials: Sequence[str]) -> Preview:
    """Return what computes the preview, safe on any thread."""
    known = previewed_fleet(station, plan, serials)
    return lambda: _view(known, known.needs())


def previewed_fleet(station: Station, plan: SurveyPlan, serials: Sequence[str]) -> PreviewedFleet:
    """Return a survey's plan with these vehicles.

    Without serials it is for one drone that takes off at the region's south-west corner.
    """
    air = station.airspace
    serials = tuple(dict.fromkeys(serials))
    found = [station.fleet.vehicles.get(serial) for serial in serials]
    vehicles = [vehicle for vehicle in found if vehicle is not None]
    problem = _problem(station, serials, vehicles)
    fleet = [_surveyor(station, vehicle) for vehicle in vehicles]
    if not fleet:
        ground_m = float(air.ground_up_m(np.array([corner_of(plan)]))[0])
        known_m = None if np.isnan(ground_m) else ground_m
        fleet = [Surveyor("", corner_of(plan), takeoff_up_m=known_m)]
    energy = station.settings.safety.energy
    landing_s = energy.landing_s(plan.survey.height_m)
    batteries = Batteries(_full_s(station, plan, vehicles), landing_s=landing_s)
    fastest_mps = air.airspace.limits.max_speed_mps
    named = {vehicle.serial or "": vehicle.display_name for vehicle in vehicles}
    names = {"": "one drone", **named}
    return PreviewedFleet(plan, tuple(fleet), names, batteries, problem, fastest_mps)


def _problem(
    station: Station, serials: Sequence[str], vehicles: Sequence[VehicleState]
) -> str | None:
    known = {vehicle.serial for vehicle in vehicles}
    for serial in serials:
        if serial not in known:
            return f"Vehicle {serial!a} not found"
    for vehicle in vehicles:
        if vehicle_enu_m(station.airspace, vehicle) is None:
            is_placed = vehicle.position.value is not None
            why = "height of its takeoff point" if is_placed else "position"
            return f"{vehicle.display_name} has no known {why}"
        if vehicle.serial in station.imaging.imagers:
            return f"{vehicle.display_name} is an imaging drone and cannot join a survey"
    return None


def _surveyor(station: Station, vehicle: VehicleState) -> Surveyor:
    place_m, home_m = (at(station.airspace, vehicle) for at in (vehicle_enu_m, home_enu_m))
    here = (0.0, 0.0) if place_m is None else (float(place_m[0]), float(place_m[1]))
    return Surveyor(
        vehicle.serial or "",
        here,
        time_left_s=time_left_s(vehicle, station.airspace, station.settings.safety.energy),
        home_m=None if home_m is None else (float(home_m[0]), float(home_m[1])),
        takeoff_up_m=takeoff_up_m(station.airspace, vehicle),
    )


def _full_s(station: Station, plan: SurveyPlan, vehicles: Sequence[VehicleState]) -> float | None:
    """Return how long the least enduring vehicle's full battery lasts; None if one is unknown."""
    lasting_s: list[float] = []
    for vehicle in vehicles:
        full = replace(
            vehicle,
            battery_fraction=Stamped(1.0, 0),
            height_above_takeoff_m=Stamped(plan.survey.height_m, 0),
        )
        full_s = time_left_s(full, station.airspace, station.settings.safety.energy)
        if full_s is None:
            return None
        lasting_s.append(full_s)
    return min(lasting_s, default=None)


def _view(known: PreviewedFleet, made: SurveyEstimate | Refusal) -> schema.SurveyEstimateView:
    plan, fleet = known.plan, known.fleet
    survey, needs = plan.survey, made if isinstance(made, SurveyEstimate) else None
    limit, *_others = speed_limits(
        survey.camera,
        survey.height_m,
        survey.front_overlap,
        EXPOSURE_S,
        known.fastest_mps,
        stops_in_rows=survey.is_above_ground,
    )
    return schema.SurveyEstimateView(
        survey_id=survey.id,
        refusal=made.reason if isinstance(made, Refusal) else None,
        drones=[
            schema.DroneEstimateView(
                serial=drone.serial or None,
                vehicle_name=known.names.get(drone.serial, "one drone"),
                time_s=drone.time_s,
                flights=len(drone.flights),
            )
            for drone in (() if needs is None else needs.drones)
        ],
        **asdict(plan_figures(plan, fleet, needs, limit, EXPOSURE_S)),
    )
