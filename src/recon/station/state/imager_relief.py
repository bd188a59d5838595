"""What predicts the reliefs of imaging drones, in this run."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from recon.guidance.imager_relief import Charge, MissingGround
from recon.model.geo import LatLon


@dataclass(frozen=True, slots=True)
class HoverPlace:
    """Where an imaging drone hovered last, `up_m` above the site; until `until_ns`."""

    place: LatLon
    up_m: float
    until_ns: int


@dataclass(frozen=True, slots=True)
class ImagerOutlook:
    """Time at which a hovering imaging drone must return; None with the reason while unknown."""

    return_due_ns: int | None
    return_due_in_s: float = 0.0
    """Time left at the last check, a second ago at most."""
    unknown: str = ""


@dataclass(frozen=True, slots=True)
class WithoutLight:
    """Time since which a survey has had no shade map, and its area of unknown light then."""

    since_ns: int
    sun_unknown_m2: float


@dataclass(frozen=True, slots=True)
class SurveyOutlook:
    """What a running survey still needs (None: unknown), and since when it has no shade map."""

    missing: tuple[MissingGround, ...] = ()
    needs_s: float | None = None
    without_light: WithoutLight | None = None


@dataclass(frozen=True, slots=True)
class Recall:
    """The survey for which an imaging drone was recalled automatically, and the time."""

    survey_id: int
    at_ns: int


@dataclass(frozen=True, slots=True)
class Reliefs:
    """Charges, places and outlooks by serial, surveys' outlooks by id.

    `recalled`: those recalled automatically, by serial.
    """

    charges: Mapping[str, tuple[Charge, ...]] = field(default_factory=dict)
    places: Mapping[str, HoverPlace] = field(default_factory=dict)
    outlooks: Mapping[str, ImagerOutlook] = field(default_factory=dict)
    surveys: Mapping[int, SurveyOutlook] = field(default_factory=dict)
    recalled: Mapping[str, Recall] = field(default_factory=dict)
    checked_at_ns: int | None = None
