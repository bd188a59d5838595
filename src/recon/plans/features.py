"""What each format can say of a flight: one table. What it cannot is named, or refused.

A feature that is not in a format's row is in its files. `ByHand` is a sentence of what the pilot
sets in the other program; `NotHeld` is why the file would be flown wrong.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum, StrEnum
from types import MappingProxyType

from recon.plans.flight_plan import AtEnd, ExportedPlan, PlanExportError


class FormatName(Enum):
    """The formats, by the suffix of their files."""

    WPML = ".kmz"
    QGC_MISSION = ".plan"
    QGC_SURVEY = ".survey.plan"
    WAYPOINTS = ".waypoints"
    LITCHI = ".csv"
    KML = ".kml"
    GPX = ".gpx"


class FlightFeature(StrEnum):
    """What a flight may have, and some formats cannot say."""

    HEIGHT = "height above takeoff"
    VARYING_HEIGHTS = "heights that follow the ground"
    SPEED = "speed"
    STOPS = "stops at corners"
    CURVED = "curved turns"
    LOITER = "stays at waypoints"
    GIMBAL_PITCH = "gimbal pitch"
    PHOTO_TIMER = "photo timer"
    PHOTO_DISTANCE = "photos by distance"
    RETURN_HOME = "return home at the end"
    LAND = "landing at the end"
    HOVER = "hover at the end"
    LOST_SIGNAL = "return home on a lost signal"


@dataclass(frozen=True, slots=True)
class ByHand:
    """What the pilot sets, as a sentence; `{...}` are the figures of `_figures`."""

    sentence: str


@dataclass(frozen=True, slots=True)
class NotHeld:
    """Why a format cannot hold a plan, as a sentence."""

    sentence: str


_TIMER = "the camera's timer: set it to {every_s:g} s"
_DISTANCE = "photos: set the program to one every {every_m:.1f} m"
_AT_END = "the end: set it to {at_end} in the program"
_AUTOPILOT_LOST = "a lost signal: set the autopilot's failsafe to return home"
_NO_CURVES = NotHeld(
    "the format has no corner radius: plan without curved turns, or write .kmz or .csv"
)
_MAVLINK: Mapping[FlightFeature, ByHand | NotHeld] = {
    FlightFeature.STOPS: ByHand(
        "corners: the autopilot rounds them within its acceptance radius (WPNAV_RADIUS, "
        "NAV_ACC_RAD); keep that small"
    ),
    FlightFeature.CURVED: _NO_CURVES,
    FlightFeature.LOST_SIGNAL: ByHand(_AUTOPILOT_LOST),
}
_DRAWING: Mapping[FlightFeature, ByHand | NotHeld] = {
    FlightFeature.VARYING_HEIGHTS: NotHeld(
        "the format has no heights above takeoff, and those of this plan differ: write .kmz, .plan,"
        " .waypoints or .csv"
    ),
    FlightFeature.SPEED: ByHand("speed: set it to {speed_mps:g} m/s"),
    FlightFeature.STOPS: ByHand("corners: set the program to stop at them"),
    FlightFeature.CURVED: _NO_CURVES,
    FlightFeature.LOITER: NotHeld(
        "the format has no stays at waypoints: write .kmz, .plan, .waypoints or .csv"
    ),
    FlightFeature.GIMBAL_PITCH: ByHand("gimbal: set it to {gimbal_pitch_deg:g} degrees"),
    FlightFeature.PHOTO_TIMER: ByHand(_TIMER),
    FlightFeature.PHOTO_DISTANCE: ByHand(_DISTANCE),
    FlightFeature.RETURN_HOME: ByHand(_AT_END),
    FlightFeature.LAND: ByHand(_AT_END),
    FlightFeature.HOVER: ByHand(_AT_END),
    FlightFeature.LOST_SIGNAL: ByHand("a lost signal: set the aircraft to return home"),
}

CANNOT: Mapping[FormatName, Mapping[FlightFeature, ByHand | NotHeld]] = MappingProxyType(
    {
        FormatName.WPML: {},
        FormatName.QGC_MISSION: _MAVLINK,
        FormatName.QGC_SURVEY: {
            **_MAVLINK,
            FlightFeature.LOITER: NotHeld("a survey item has no stays at waypoints: write .plan"),
            FlightFeature.PHOTO_TIMER: ByHand(
                "a survey item has photos by distance only: it takes one every {every_m:.1f} m, "
                "which is {every_s:g} s at {speed_mps:g} m/s"
            ),
        },
        FormatName.WAYPOINTS: _MAVLINK,
        FormatName.LITCHI: {
            FlightFeature.RETURN_HOME: ByHand(_AT_END),
            FlightFeature.LAND: ByHand(_AT_END),
            FlightFeature.HOVER: ByHand(_AT_END),
            FlightFeature.LOST_SIGNAL: ByHand(
                "a lost signal: set the aircraft, and Litchi's mission settings, to return home"
            ),
        },
        FormatName.KML: {
            **_DRAWING,
            FlightFeature.HEIGHT: ByHand(
                "height: KML counts from the ground under each place; set the program to "
                "{height_m:g} m above takeoff"
            ),
        },
        FormatName.GPX: {
            **_DRAWING,
            FlightFeature.HEIGHT: ByHand(
                "height: GPX has elevations above the sea only; set the program to {height_m:g} m "
                "above takeoff"
            ),
        },
    }
)


def features_of(plan: ExportedPlan) -> frozenset[FlightFeature]:
    """Return what a flight has."""
    every_s = None if plan.photos is None else plan.photos.every_s
    has = {
        FlightFeature.HEIGHT: True,
        FlightFeature.VARYING_HEIGHTS: not plan.is_level,
        FlightFeature.SPEED: True,
        FlightFeature.STOPS: not plan.curved,
        FlightFeature.CURVED: plan.curved,
        FlightFeature.LOITER: any(each.loiter_s for each in plan.waypoints),
        FlightFeature.GIMBAL_PITCH: any(
            each.gimbal_pitch_deg is not None for each in plan.waypoints
        ),
        FlightFeature.PHOTO_TIMER: every_s is not None,
        FlightFeature.PHOTO_DISTANCE: plan.photos is not None and every_s is None,
        FlightFeature.RETURN_HOME: plan.at_end is AtEnd.RETURN_HOME,
        FlightFeature.LAND: plan.at_end is AtEnd.LAND,
        FlightFeature.HOVER: plan.at_end is AtEnd.HOVER,
        FlightFeature.LOST_SIGNAL: True,
    }
    return frozenset(feature for feature, is_so in has.items() if is_so)


def by_hand(name: FormatName, plans: Iterable[ExportedPlan]) -> tuple[str, ...]:
    """Return what the pilot sets in the other program, each sentence once.

    Raises `PlanExportError` for what the format would have flown wrong.
    """
    found: dict[str, None] = {}
    for plan in plans:
        has = features_of(plan)
        for feature in FlightFeature:
            lack = CANNOT[name].get(feature) if feature in has else None
            if isinstance(lack, NotHeld):
                raise PlanExportError(f"{name.value} cannot hold {feature}: {lack.sentence}")
            if lack is not None:
                found[lack.sentence.format(**_figures(plan))] = None
    return tuple(found)


def _figures(plan: ExportedPlan) -> dict[str, object]:
    speed_mps = plan.waypoints[0].speed_mps
    pitches_deg = (each.gimbal_pitch_deg for each in plan.waypoints)
    photos = plan.photos
    return {
        "height_m": plan.heights_m[1],
        "speed_mps": speed_mps,
        "gimbal_pitch_deg": next((deg for deg in pitches_deg if deg is not None), 0.0),
        "every_s": 0.0 if photos is None else photos.every_s or 0.0,
        "every_m": 0.0 if photos is None else photos.distance_m(speed_mps),
        "at_end": plan.at_end.value,
    }
