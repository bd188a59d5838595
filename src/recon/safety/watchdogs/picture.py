"""The one picture all watchdogs look at."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from recon.model.authority import AuthorityHolder
from recon.model.geo import LatLon
from recon.model.intent import Commanded, Intent
from recon.model.severity import Severity
from recon.model.units import NS_PER_S
from recon.model.vehicle import FlightMode, VehicleState
from recon.safety.airspace import PreparedAirspace
from recon.safety.prediction import Flyer, HazardArea, PredictionSettings
from recon.safety.separation_minima import SeparationMinima, watchdog_minima
from recon.safety.settings import EnergySettings, WatchdogSettings
from recon.safety.watchdogs.ahead import Ahead
from recon.safety.watchdogs.finding import Finding

_COMING_DOWN_MODES = frozenset(
    {FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING, FlightMode.GO_HOME}
)


@dataclass(frozen=True, slots=True)
class Held:
    """The station has held a vehicle: since when, and how fast it was then."""

    since_ns: int
    speed_mps: float

    def holds_against(self, intent: Intent) -> bool:
        """Return whether nothing newer has been ordered."""
        return intent.since_ns <= self.since_ns or intent.commanded is Commanded.HOLD


def hold_words(held: Held | None, refused: str) -> str:
    """Return what became of a hold, to follow the vehicle's name; empty when none was given."""
    if refused:
        return f"could not be told to hold ({refused})"
    return "" if held is None else "has been told to hold"


@dataclass(frozen=True, slots=True)
class Before:
    """A vehicle's telemetry before the newest: where it was, how fast, and when."""

    place: LatLon
    speed_mps: float
    at_ns: int


@dataclass(frozen=True, slots=True)
class WatchedVehicle:
    """A vehicle that flies or may, and what the station knows beside its state.

    `flyer` is None while it has never told where it is; `hazard area` is set while it is not heard.
    `stick_quiet_s` is set while sticks are streamed to it: how long none was sent.
    `hold_refused` tells why a hold could not be given to it just now.
    """

    state: VehicleState
    intent: Intent = Intent()
    holder: AuthorityHolder = AuthorityHolder.OPERATOR
    flyer: Flyer | None = None
    hazard: HazardArea | None = None
    held: Held | None = None
    before: Before | None = None
    is_imager: bool = False
    stick_quiet_s: float | None = None
    hold_refused: str = ""

    @property
    def key(self) -> str:
        """What its findings are told apart by."""
        return self.state.serial or f"link {self.state.link_id}"

    @property
    def name(self) -> str:
        """The name people see."""
        return self.state.display_name

    @property
    def is_heard_flying(self) -> bool:
        """Whether it tells of itself that it flies, and where."""
        return self.flyer is not None and self.hazard is None and self.state.is_flying.value is True

    @property
    def may_fly_on_unseen(self) -> bool:
        """Whether it is not heard and was sent a mission: its app may fly that on by itself."""
        return self.hazard is not None and self.intent.commanded is Commanded.MISSION

    @property
    def is_coming_down(self) -> bool:
        """Whether it lands or returns: it is on its way out of the air."""
        return (
            self.intent.commanded in (Commanded.LAND, Commanded.RETURN)
            or self.state.flight_mode.value in _COMING_DOWN_MODES
        )

    @property
    def may_be_held(self) -> bool:
        """Whether a hold would be the station's to give: in the air, known, not the pilot's."""
        return (
            self.is_heard_flying
            and self.state.serial is not None
            and self.holder is not AuthorityHolder.PILOT
            and not self.hold_refused
        )

    @property
    def hold_words(self) -> str:
        """What became of a hold for it, to follow its name; empty when none was given."""
        return hold_words(self.held, self.hold_refused)

    def was_held_within_s(self, now_ns: int, seconds: float) -> bool:
        """Return whether the station has held it so lately."""
        return self.held is not None and now_ns - self.held.since_ns < seconds * NS_PER_S

    def finding(
        self, rule: str, severity: Severity, text: str, *, about: str = "", after_s: float = 0.0
    ) -> Finding:
        """Return a finding about this vehicle, which its text names first."""
        return Finding(
            key=f"{rule}:{self.key}{about}",
            rule=rule,
            severity=severity,
            vehicle_name=self.name,
            text=f"{self.name}: {text}",
            serial=self.state.serial,
            link_id=self.state.link_id,
            after_s=after_s,
        )


@dataclass(frozen=True, slots=True)
class Picture:
    """Everything that is watched, at one moment.

    `flying` are heard to fly. `unseen` are not heard any more, and may be flying on a mission.
    `ahead` is of the one and then of the other, in their order. `since_ns` says since when each
    finding has been made, by its key.
    """

    now_ns: int
    watched: tuple[WatchedVehicle, ...]
    flying: tuple[WatchedVehicle, ...]
    unseen: tuple[WatchedVehicle, ...]
    ahead: Ahead
    airspace: PreparedAirspace
    settings: WatchdogSettings = field(default_factory=WatchdogSettings)
    prediction: PredictionSettings = field(default_factory=PredictionSettings)
    energy: EnergySettings = field(default_factory=EnergySettings)
    since_ns: Mapping[str, int] = field(default_factory=dict)
    is_hold_on: bool = True

    @property
    def foreseen(self) -> tuple[WatchedVehicle, ...]:
        """Those that `ahead` is of."""
        return self.flying + self.unseen

    @property
    def minima(self) -> SeparationMinima:
        """The minima below which the separation watchdog raises an alarm."""
        return watchdog_minima(self.airspace.airspace.limits, self.settings)

    def lasted_s(self, key: str) -> float:
        """Return how long a finding has been made, 0 for a new one."""
        since_ns = self.since_ns.get(key)
        return 0.0 if since_ns is None else (self.now_ns - since_ns) / NS_PER_S
