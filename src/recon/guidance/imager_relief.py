"""The relief of an imaging drone: when it must return, what shows as much, and the path there.

An imaging drone hovers until its charge is what the route home and the reserve take. Its use is
read from the changes of the charge that it reports, in whole percent; so the moment is known to
about a quarter of a minute. How long a survey lasts follows from its missing ground and its recent
pace.

The spare one flies to the place in a layer of its own, so that both may hover there together.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from recon.geo.distance import horizontal_distance_m
from recon.model.airspace import LAYER_SPACING_M
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.shade import MaskMap
from recon.model.units import ns_to_seconds, seconds_to_ns


@dataclass(frozen=True, slots=True)
class ImagerReliefSettings:
    """Settings of reliefs; times in seconds."""

    checked_every_s: float = 1.0
    """Batteries and light change in seconds."""

    warned_before_s: float = 300.0
    """Time to fetch a drone, and to fly it there: takeoff, 100 m up and 500 m across take two
    minutes."""

    early_s: float = 150.0
    """Time by which an automatic relief begins early: for refusals, and for its shade method to
    learn the ground while both are there."""

    refused_again_s: float = 15.0
    """Traffic in the way passes; the battery does not wait."""

    called_again_s: float = 60.0
    """One that was recalled and hovers again, excluded from the fleet return, is called anew."""

    speed_mps: float = 8.0
    """Speed on the way, as for a move upwind."""

    takeoff_s: float = 15.0
    """Time from the order to the climb."""

    climb_mps: float = 2.0
    """Climb rate of the energy model."""

    late_by_s: float = 60.0
    """Allowance for gusts and headwind, in addition to the time that the path takes."""

    telemetry_within_s: float = 3.0
    """Largest age of telemetry, as in a fleet return: beyond it a vehicle may do anything."""

    layer_m: float = LAYER_SPACING_M
    """Vertical distance between the two at the place: that of two layers of a fleet return."""

    layer_step_m: float = 4.0
    layers: int = 5
    """Heights that are tried to either side."""

    lowest_m: float = 20.0
    """Lowest height, as for a survey's approaches: trees and buildings are in a zone, or lower."""

    below_ceiling_m: float = 1.0
    """Margin under the site's ceiling, as in a fleet return."""

    stays_s: float = 300.0
    """What the spare one's battery must give at the place: less is not worth the flight."""

    maps_in_a_row: int = 3
    """One map may come by chance from the climb's last frame; three are a camera that works."""

    map_gap_s: float = 5.0
    """Longest gap between two successive maps; older ones do not count for a survey's photos."""

    maps_within_s: float = 150.0
    """Longest wait at the place for maps that show enough: a shade method learns the ground for a
    minute or two, of rendered frames under cumulus."""

    first_map_within_s: float = 60.0
    """Longest wait at the place for any shade map: without one, its camera or its placing fails."""

    shows_share: float = 0.7
    """Share of the ground with light known to the other one and visible from its own height. A
    method that has just begun knew 72 to 79 % of it for 40 s, of rendered frames under cumulus."""

    camera_quiet_s: float = 5.0
    """Time without a frame after which its camera is taken to be off, and is switched on."""


RELIEF_SETTINGS = ImagerReliefSettings()

FRAMES_HZ = 1.0
"""What the shade methods are made for."""

CHARGES_KEPT = 13
"""Twelve percent, about three minutes of hovering: the climb before is forgotten by then."""

LEAST_STEPS = 3
JUMP_FRACTION = 0.05
"""A charge that rises by more is a fresh battery's; by less, the load has fallen. One that falls by
more at once has lost a cell, or telemetry was away: neither is how it is used."""

PROGRESS_KEPT_S = 300.0
LEAST_PROGRESS_S = 60.0


@dataclass(frozen=True, slots=True)
class Charge:
    """A battery fraction, and when it was first reported."""

    at_ns: int
    fraction: float


@dataclass(frozen=True, slots=True)
class MissingGround:
    """The ground that a survey has still to image, at one moment."""

    at_ns: int
    area_m2: float


def with_charge(charges: tuple[Charge, ...], at_ns: int, fraction: float) -> tuple[Charge, ...]:
    """Return the changes of a charge with one more report; a jump begins anew."""
    if not charges or abs(fraction - charges[-1].fraction) > JUMP_FRACTION:
        return (Charge(at_ns, fraction),)
    if fraction >= charges[-1].fraction:
        return charges
    return (*charges, Charge(at_ns, fraction))[-CHARGES_KEPT:]


def use_per_s(charges: tuple[Charge, ...]) -> float | None:
    """Return the fraction used in a second, None before it fell by three steps.

    The first report does not count: it came some time after its change.
    """
    changes = charges[1:]
    if len(changes) <= LEAST_STEPS:
        return None
    first, last = changes[0], changes[-1]
    return (first.fraction - last.fraction) / ns_to_seconds(last.at_ns - first.at_ns)


def return_due_ns(newest: Charge, uses_per_s: float, needed: float) -> int:
    """Return when the charge has fallen to the fraction that is needed; it may be past."""
    return newest.at_ns + seconds_to_ns((newest.fraction - needed) / uses_per_s)


def with_missing(
    history: tuple[MissingGround, ...], newest: MissingGround
) -> tuple[MissingGround, ...]:
    """Return a survey's missing ground of the last five minutes."""
    kept_ns = seconds_to_ns(PROGRESS_KEPT_S)
    return (*(each for each in history if newest.at_ns - each.at_ns <= kept_ns), newest)


def survey_needs_s(history: tuple[MissingGround, ...], now_ns: int) -> float | None:
    """Return how long a survey needs for its missing ground at its recent pace.

    None in its first minute, and while it images nothing: it waits for sun, or no vehicle flies.
    """
    if not history:
        return None
    first, last = history[0], history[-1]
    took_s = ns_to_seconds(last.at_ns - first.at_ns)
    imaged_m2 = first.area_m2 - last.area_m2
    if last.area_m2 <= 0.0:
        return 0.0
    if took_s < LEAST_PROGRESS_S or imaged_m2 <= 0.0:
        return None
    return max(0.0, last.area_m2 * took_s / imaged_m2 - ns_to_seconds(now_ns - last.at_ns))


def shown_share(valid: MaskMap, others_valid: MaskMap | None) -> float:
    """Return the share of the cells (R, C) known to another drone that one knows, 0 to 1.

    Without another's map, or with nothing known to it, any known cell is enough.
    """
    if others_valid is None or not others_valid.any():
        return 1.0 if valid.any() else 0.0
    return float((valid & others_valid).sum() / others_valid.sum())


def least_share(height_m: float | None, others_height_m: float | None) -> float:
    """Return the share that must be shown from a height: from lower, less ground is in view."""
    if height_m is None or not others_height_m:
        return RELIEF_SETTINGS.shows_share
    lower = min(1.0, max(0.0, height_m) / others_height_m)
    return RELIEF_SETTINGS.shows_share * lower * lower


def layers_m(
    height_m: float, apart_m: float, ceiling_m: float, *, may_be_above: bool
) -> Iterator[float]:
    """Yield heights beside one that is taken, the nearest first.

    All are above the same point; `apart_m` is the least distance. Below it is one layer more: the
    route home of the one above begins with a descent into a layer of the fleet return.
    """
    settings = RELIEF_SETTINGS
    least_m = max(settings.layer_m, apart_m)
    steps_m = [step * settings.layer_step_m for step in range(settings.layers)]
    above_m = [least_m + step_m for step_m in steps_m] if may_be_above else []
    below_m = [-least_m - settings.layer_m - step_m for step_m in steps_m]
    for off_m in sorted([*above_m, *below_m], key=lambda each: (abs(each), each < 0.0)):
        if settings.lowest_m <= height_m + off_m <= ceiling_m:
            yield height_m + off_m


def relief_mission(
    here: LatLon, place: LatLon, height_m: float, gimbal_pitch_deg: float | None
) -> Mission:
    """Return the mission straight up or down to a height above takeoff, and across to a place."""
    across = Waypoint(
        place.latitude_deg,
        place.longitude_deg,
        height_m,
        RELIEF_SETTINGS.speed_mps,
        gimbal_pitch_deg=gimbal_pitch_deg,
    )
    # Right above where it stands, a leg of no length would be refused.
    first_m = height_m if horizontal_distance_m(here, place) > 1.0 else height_m - 2.0
    above = replace(
        across,
        latitude_deg=here.latitude_deg,
        longitude_deg=here.longitude_deg,
        height_above_takeoff_m=first_m,
        gimbal_pitch_deg=None,
    )
    return Mission((above, across), purpose="relief")


def transit_time_s(here: LatLon, up_m: float, place: LatLon) -> float:
    """Return how long the path takes: takeoff, climb or descent by `up_m`, and across."""
    settings = RELIEF_SETTINGS
    across_s = horizontal_distance_m(here, place) / settings.speed_mps
    return settings.takeoff_s + abs(up_m) / settings.climb_mps + across_s
