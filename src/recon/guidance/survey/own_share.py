"""A vehicle's share of the missing ground: side by side, so that all would finish together."""

from collections.abc import Mapping, Sequence

import numpy as np

from recon.guidance.survey.plan import SurveyPlan
from recon.guidance.survey.segments import ExpectedSun
from recon.guidance.survey.state import AssignedMission, Surveyor
from recon.model.arrays import BoolArray, FloatArray
from recon.model.units import ns_to_seconds


def own_share(
    surveyor: Surveyor,
    able: Sequence[Surveyor],
    flights: Mapping[str, AssignedMission],
    free: BoolArray,
    expected: ExpectedSun,
    plan: SurveyPlan,
    now_ns: int,
) -> BoolArray:
    """Return (S,): a vehicle's part of the `free` (S,) segments, by row and along.

    Vehicles are in the order in which they, or the ends of their missions, lie across. Those on a
    mission get less, and ground without sun counts `least_worth`.
    """
    across_m = {each.serial: _next_across_m(each, flights, plan) for each in able}
    order = sorted(across_m, key=lambda serial: (across_m[serial], serial))
    rate_m2ps = plan.survey.speed_mps * plan.lattice.spacing_m
    lit = np.maximum(plan.settings.least_worth, expected.probability.max(axis=1))
    work_s = np.where(free, expected.missing_m2 * lit, 0.0) / rate_m2ps
    done_s = np.cumsum(work_s)
    busy_s = np.array([_busy_s(flights.get(serial), now_ns) for serial in order])
    share_s = np.maximum(0.0, finished_together_s(busy_s, float(done_s[-1])) - busy_s)
    until_s = np.cumsum(share_s)
    own = order.index(surveyor.serial)
    middle_s = done_s - work_s / 2.0
    is_own: BoolArray = (middle_s <= until_s[own]) & (middle_s >= until_s[own] - share_s[own])
    return is_own & free


def _next_across_m(
    surveyor: Surveyor, flights: Mapping[str, AssignedMission], plan: SurveyPlan
) -> float:
    flight = flights.get(surveyor.serial)
    place_m = surveyor.place_m if flight is None else flight.corners_m[-1]
    return plan.lattice.along_across_of(place_m)[1]


def _busy_s(flight: AssignedMission | None, now_ns: int) -> float:
    return 0.0 if flight is None else max(0.0, ns_to_seconds(flight.ends_at_ns - now_ns))


def finished_together_s(busy_s: FloatArray, work_s: float) -> float:
    """Return when vehicles that are busy for (N,) seconds finish this work together, if each
    takes its part as soon as it can."""
    ordered = np.sort(busy_s)
    for count in range(1, len(ordered)):
        together_s = (work_s + float(ordered[:count].sum())) / count
        if together_s <= ordered[count]:
            return together_s
    return (work_s + float(ordered.sum())) / len(ordered)
