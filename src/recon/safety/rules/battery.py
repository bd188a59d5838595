"""The battery suffices for the route home and a reserve from every point of a flight."""

from math import ceil, floor, isfinite

from recon.model.command import BODY_NAMES, Body, Command, Refusal, mission_of_body
from recon.model.vehicle import BatteryWarning, VehicleState
from recon.safety.energy import Need, consumption, leads_away, need_of
from recon.safety.path.order_path import is_stop
from recon.safety.situation import Situation

RULE = "battery"
ROUNDING = 1e-9
"""Rounding that makes 0.62 show as 62 percent, not 63 or 61."""


def battery(command: Command, situation: Situation) -> Refusal | None:
    """Refuse motion after which home is not reached with the site's reserve.

    Motion that does not lead away from home must leave the minimum for a landing instead of the
    reserve; a takeoff leads away. A stick that only stops the vehicle needs nothing.
    """
    vehicle, body = situation.vehicle, command.body
    if vehicle is None or not command.moves or is_stop(command, situation):
        return None
    energy = situation.settings.energy
    if (
        vehicle.battery_warning.value is BatteryWarning.NONE
        and _reserve(situation) >= energy.landing_fraction
        and _short(vehicle, body, True, situation) is None
    ):
        return None  # enough wherever it leads
    is_away = command.takeoff or leads_away(body, vehicle, situation.airspace, energy)
    return _warned(vehicle, is_away) or _short(vehicle, body, is_away, situation)


def _warned(vehicle: VehicleState, is_away: bool) -> Refusal | None:
    """The aircraft's own two thresholds count, whatever the energy model computes."""
    warning = vehicle.battery_warning.value
    if warning is BatteryWarning.SERIOUS:
        return _refused(
            vehicle, "the aircraft reports a critically low battery; land it or recall it now"
        )
    if not is_away or warning is BatteryWarning.NONE:
        return None
    if warning is None:
        return _refused(vehicle, "battery warning unknown; check its companion app")
    return _refused(
        vehicle, "the aircraft reports a low battery: only motion towards home is accepted"
    )


def _short(
    vehicle: VehicleState, body: Body, is_away: bool, situation: Situation
) -> Refusal | None:
    """The energy model's answer; while that is unknown the motion is refused."""
    energy = situation.settings.energy
    uses = consumption(vehicle, situation.airspace, energy)
    if uses is None:
        return _refused(
            vehicle,
            "endurance unknown, so the route home cannot be checked; write endurance_min = MINUTES "
            f'under [[vehicles]] serial = "{vehicle.serial}" in site.toml',
        )
    has = vehicle.battery_fraction.value
    if has is None:
        return _refused(vehicle, "battery charge unknown; check its companion app")
    need = need_of(uses, vehicle, body)
    if need is None:
        return _refused(vehicle, "position or home unknown, so the route home cannot be checked")
    left = _reserve(situation) if is_away else energy.landing_fraction
    return None if need.whole + left <= has else _too_little(vehicle, body, need, left, has)


def _reserve(situation: Situation) -> float:
    return situation.airspace.airspace.limits.battery_reserve_fraction


def _too_little(vehicle: VehicleState, body: Body, need: Need, left: float, has: float) -> Refusal:
    name = BODY_NAMES[type(body)].replace("_", " ")
    end = f"waypoint {need.at}" if mission_of_body(body) is not None else "its end"
    flown = f"{_near(need.flown)} % to {end}, " if need.at > 0 else ""
    return _refused(
        vehicle,
        f"the {name} needs {_up(need.whole + left)} % of its battery; got {_down(has)} %: "
        f"{flown}{_near(need.back)} % home from there, and {_near(left)} % reserve; fly less far, "
        "or change the battery",
        battery_fraction=has,
        min_fraction=need.whole + left,
        reserve_fraction=left,
    )


def _refused(vehicle: VehicleState, reason: str, **parameters: float) -> Refusal:
    return Refusal(RULE, f"{vehicle.display_name}: {reason}", parameters=parameters)


def _up(fraction: float) -> str:
    return f"{ceil(100.0 * fraction - ROUNDING)}" if isfinite(fraction) else "more than 100"


def _near(fraction: float) -> str:
    return f"{100.0 * fraction:.0f}"


def _down(fraction: float) -> str:
    return f"{floor(100.0 * fraction + ROUNDING)}"
