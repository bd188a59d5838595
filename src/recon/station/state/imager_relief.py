"""Reliefs of imaging drones: the newest one, and what predicts the next.

All of it is of this run: after a restart no relief continues.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from recon.guidance.imager_relief import Charge, MissingGround
from recon.model.geo import LatLon
from recon.station.state.imager_motion import ByItself, ImagerMotion


@dataclass(frozen=True, slots=True)
class HoverPlace:
    """Where an imaging drone hovered last, `up_m` above the site; until `until_ns`."""

    place: LatLon
    up_m: float
    until_ns: int


@dataclass(frozen=True, slots=True)
class ImagerOutlook:
    """When an imaging drone that hovers must leave; None with the reason while that is unknown."""

    leaves_at_ns: int | None
    leaves_in_s: float = 0.0
    """At the last check, a second ago at most."""
    unknown: str = ""


@dataclass(frozen=True, slots=True)
class WithoutLight:
    """Since when a survey has had no shade map, and the area of unknown light it had then."""

    since_ns: int
    sun_unknown_m2: float


@dataclass(frozen=True, slots=True)
class SurveyOutlook:
    """What a running survey still needs (None: unknown), and since when it has no shade map."""

    missing: tuple[MissingGround, ...] = ()
    needs_s: float | None = None
    without_light: WithoutLight | None = None


@dataclass(frozen=True, slots=True)
class CalledHome:
    """For which survey an imaging drone was called home automatically, and when."""

    survey_id: int
    at_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ImagerRelief(ImagerMotion):
    """One relief: `serial` takes the place of `relieved`; the same one returns to its own place."""

    rule: ClassVar[str] = "imager_relief"
    words: ClassVar[str] = "relief"
    doing: ClassVar[str] = "takes an imaging drone's place"

    relieved: str
    relieved_name: str
    within_s: float
    link_id: int | None
    person: str = ""
    maps: int = 0
    """Shade maps in a row since it is at the place, the newest taken at `map_at_ns`."""
    map_at_ns: int = 0
    has_map: bool = False
    """Whether any shade map of its own came since then."""
    is_camera_ordered: bool = False
    home_refused: str = ""
    """Why the relieved one could not be called home at the end."""

    @property
    def comes_back(self) -> bool:
        """Whether it returns to its own place."""
        return self.serial == self.relieved


@dataclass(frozen=True, slots=True)
class Reliefs(ByItself):
    """The newest relief; charges, places and outlooks by serial, surveys' outlooks by id.

    `called_home`: those called home automatically, by serial.
    """

    newest: ImagerRelief | None = None
    charges: Mapping[str, tuple[Charge, ...]] = field(default_factory=dict)
    places: Mapping[str, HoverPlace] = field(default_factory=dict)
    outlooks: Mapping[str, ImagerOutlook] = field(default_factory=dict)
    surveys: Mapping[int, SurveyOutlook] = field(default_factory=dict)
    called_home: Mapping[str, CalledHome] = field(default_factory=dict)
    checked_at_ns: int | None = None
