"""Who leads a vehicle, and its preflight checklist, as a program reads and says it."""

from typing import TYPE_CHECKING

import msgspec

from recon.model.authority import AuthorityHolder
from recon.model.command import Refusal

if TYPE_CHECKING:
    from recon.client.http import Http


class PreflightPoint(msgspec.Struct, frozen=True):
    """One point of the checklist: `state` is ok, attention, unknown or fails."""

    key: str
    name: str
    state: str
    text: str
    to_do: str
    holds_back: bool


class PreflightOverride(msgspec.Struct, frozen=True):
    """Who let the vehicle fly missions without its checklist, and why."""

    by: str
    reason: str
    age_s: float


class Preflight(msgspec.Struct, frozen=True):
    """A vehicle's checklist, worked out when it was asked for."""

    serial: str
    name: str
    is_passed: bool
    override: PreflightOverride | None
    points: tuple[PreflightPoint, ...]

    @property
    def unmet(self) -> tuple[PreflightPoint, ...]:
        """The points that hold missions back."""
        return tuple(point for point in self.points if point.holds_back)


class WordMessage(msgspec.Struct, frozen=True):
    """What became of a word that is no order."""

    accepted: bool
    rule: str | None
    reason: str | None


async def say_holder(http: "Http", vehicle_path: str, holder: AuthorityHolder) -> Refusal | None:
    """Take a vehicle over or give it away; None when that is done."""
    asked = {"holder": holder.value}
    return await _say(http, f"{vehicle_path}/authority", asked)


async def ask_preflight(http: "Http", vehicle_path: str) -> Preflight:
    """Return a vehicle's checklist as of now."""
    return await http.get(f"{vehicle_path}/preflight", Preflight, "a preflight checklist")


async def say_override(http: "Http", vehicle_path: str, reason: str) -> Refusal | None:
    """Override a vehicle's checklist; None when that is done."""
    return await _say(http, f"{vehicle_path}/preflight/override", {"reason": reason})


async def _say(http: "Http", path: str, asked: dict[str, str]) -> Refusal | None:
    answer = await http.post(path, asked, WordMessage, "what became of a word")
    if answer.accepted:
        return None
    return Refusal(answer.rule or "unnamed", answer.reason or "no reason was given")
