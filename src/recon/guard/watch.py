"""What the guard knows, and when it holds a vehicle. Pure.

Theory of operation. The station's picture, ten times a second, is its heartbeat too. It names each
link's vehicle, whether it flies, and whether the station steers it by sticks.

    watching --no picture for `silent_s`, or the station ended--> silent: what it steered is held
    silent   --a picture--> watching; it learns what was done, and ends those orders
    any      --a person's all stop--> every vehicle that may be in the air is held; a station that
             speaks is reported the all stop, and latches it

A hold is a hover that the gate has approved by the last picture, and `repeats` more of them while
the station stays silent. As pictures age, the gate refuses it: a hover on the ground would make
apps in the field take off. Once the station has ended, the guard reads telemetry itself. A mission
is not held for a silent station: the aircraft flies it on its own, and its pilot watches it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf
from typing import TypeAlias

from recon.fleet.settings import FleetSettings
from recon.fleet.telemetry import fold_core
from recon.model.command import Command, Hover
from recon.model.event import AllStopped, Tick
from recon.model.replacing import replace
from recon.model.report import CoreReport
from recon.model.units import seconds_to_ns
from recon.model.vehicle import VehicleState
from recon.safety import ApprovedCommand, ClaimingLink, SafetySettings, Situation, approve
from recon.safety.settings import BlindStopSettings

NEVER_BLIND = SafetySettings(blind_stop=BlindStopSettings(fastest_descent_mps=inf))
"""The guard knows no ground, so no vehicle is certainly too high to have landed: it sends no hover
without fresh telemetry."""


@dataclass(frozen=True, slots=True)
class GuardSettings:
    """Times in seconds."""

    silent_s: float = 1.0
    """Ten pictures missed; a station under full load misses two or three."""

    repeat_s: float = 0.7
    repeats: int = 3
    """Repeats of a command, as the station repeats an emergency order."""

    interventions_kept: int = 64
    """What was done and no station knows of; beyond this the oldest go."""


@dataclass(frozen=True, slots=True)
class Watched:
    """One link: its vehicle as believed, and whether the station steers it."""

    name: str
    vehicle: VehicleState
    is_steered: bool = False


@dataclass(frozen=True, slots=True)
class Picture:
    """What the station believes now, by link. Times are the guard's."""

    links: Mapping[int, Watched]


@dataclass(frozen=True, slots=True)
class StationEnded:
    """The station's process is gone."""


@dataclass(frozen=True, slots=True)
class CoreRead:
    """Telemetry that the guard has read itself."""

    link_id: int
    report: CoreReport


@dataclass(frozen=True, slots=True)
class LinkGone:
    """A connection has closed."""

    link_id: int


GuardEvent: TypeAlias = Picture | StationEnded | CoreRead | LinkGone | AllStopped | Tick


@dataclass(frozen=True, slots=True)
class Intervention:
    """Something the guard did automatically; `by` is the person of an all stop.

    `serials` are of the vehicles that were to be held, `names` of those that a hover was sent to,
    `refused` of those to which the gate let none go: nothing recent shows them flying.
    """

    why: str
    serials: tuple[str, ...]
    names: tuple[str, ...]
    refused: tuple[str, ...] = ()
    by: str | None = None


@dataclass(frozen=True, slots=True)
class Repeat:
    """A hold that goes out again."""

    next_ns: int
    left: int


@dataclass(frozen=True, slots=True)
class GuardState:
    """Everything the guard knows."""

    links: Mapping[int, Watched] = field(default_factory=dict)
    picture_ns: int | None = None
    """Time of the last picture; None while the station is silent."""
    repeats: Mapping[int, Repeat] = field(default_factory=dict)
    interventions: tuple[Intervention, ...] = ()
    """Not yet known to a station."""
    settings: GuardSettings = GuardSettings()


Acted: TypeAlias = tuple[GuardState, tuple[ApprovedCommand, ...]]


def step(state: GuardState, event: GuardEvent, now_ns: int) -> Acted:
    """Return the guard after an event, and the hovers to send now."""
    match event:
        case Picture(links):
            return replace(state, links=links, picture_ns=now_ns, repeats={}), ()
        case StationEnded():
            return _hold_steered(state, "the station has ended", now_ns)
        case AllStopped(by):
            flying = [
                n for n, one in state.links.items() if one.vehicle.is_flying.value is not False
            ]
            return _hold(state, flying, "all stop at the guard", now_ns, by)
        case CoreRead(link_id, report):
            return _after_telemetry(state, link_id, report, now_ns), ()
        case LinkGone(link_id):
            links = {n: one for n, one in state.links.items() if n != link_id}
            return replace(state, links=links), ()
        case Tick():
            return _on_tick(state, now_ns)


def noted(state: GuardState) -> GuardState:
    """Return the guard once a station knows what it did."""
    return replace(state, interventions=())


def _on_tick(state: GuardState, now_ns: int) -> Acted:
    silent_s = state.settings.silent_s
    if state.picture_ns is not None and now_ns - state.picture_ns > seconds_to_ns(silent_s):
        return _hold_steered(state, f"the station was silent for {silent_s:g} s", now_ns)
    outputs: tuple[ApprovedCommand, ...] = ()
    for link_id, repeat in state.repeats.items():
        if now_ns >= repeat.next_ns:
            state = _with_repeat(state, link_id, repeat.left - 1, now_ns)
            outputs += _hover(state, link_id, now_ns)
    return state, outputs


def _hold_steered(state: GuardState, why: str, now_ns: int) -> Acted:
    steered = [link_id for link_id, one in state.links.items() if one.is_steered]
    links = {link_id: replace(one, is_steered=False) for link_id, one in state.links.items()}
    state = replace(state, links=links, picture_ns=None)
    return _hold(state, steered, why, now_ns) if steered else (state, ())


def _hold(
    state: GuardState, links: list[int], why: str, now_ns: int, by: str | None = None
) -> Acted:
    asked = {link_id: state.links[link_id] for link_id in links}
    serials = tuple(one.vehicle.serial for one in asked.values() if one.vehicle.serial is not None)
    outputs: tuple[ApprovedCommand, ...] = ()
    names: list[str] = []
    refused: list[str] = []
    for link_id, one in asked.items():
        state = _with_repeat(state, link_id, state.settings.repeats, now_ns)
        hover = _hover(state, link_id, now_ns)
        outputs += hover
        (names if hover else refused).append(one.name)
    intervention = Intervention(why, serials, tuple(names), tuple(refused), by)
    state = replace(
        state,
        interventions=(*state.interventions, intervention)[-state.settings.interventions_kept :],
    )
    return state, outputs


def _with_repeat(state: GuardState, link_id: int, left: int, now_ns: int) -> GuardState:
    others = {other: repeat for other, repeat in state.repeats.items() if other != link_id}
    if left > 0:
        others[link_id] = Repeat(now_ns + seconds_to_ns(state.settings.repeat_s), left)
    return replace(state, repeats=others)


def _hover(state: GuardState, link_id: int, now_ns: int) -> tuple[ApprovedCommand, ...]:
    """Return a hover for one link, if the gate approves it."""
    if link_id not in state.links:
        return ()
    vehicle = state.links[link_id].vehicle
    expires_at_ns = now_ns + seconds_to_ns(state.settings.repeat_s)
    command = Command(0, Hover(), "guard", now_ns, expires_at_ns, link_id=link_id)
    link = ClaimingLink(link_id, vehicle.is_flying, vehicle.reported_is_flying)
    situation = Situation(now_ns, vehicle, (link,), settings=NEVER_BLIND)
    judged = approve(command, situation)
    return (judged,) if isinstance(judged, ApprovedCommand) else ()


def _after_telemetry(
    state: GuardState, link_id: int, report: CoreReport, now_ns: int
) -> GuardState:
    watched = state.links.get(link_id)
    if watched is None:
        return state
    vehicle = fold_core(watched.vehicle, report, now_ns, FleetSettings())
    return replace(state, links={**state.links, link_id: replace(watched, vehicle=vehicle)})
