"""Nothing is flown that leaves too little battery to come home, from any point of it."""

from math import ceil, floor, isfinite

from recon.model.command import BODY_NAMES, Body, Command, FlyMission, Refusal
from recon.model.vehicle import BatteryWarning, VehicleState
from recon.safety.energy import Need, consumption, leads_away, need_of
from recon.safety.path.order_path import is_stop
from recon.safety.situation import Situation

RULE = "battery"
ROUNDING = 1e-9
"""So that 0.62 is 62 percent, and not 63 or 61."""


def battery(command: Command, situation: Situation) -> Refusal | None:
    """Refuse motion after which home is not reached with the site's reserve.

    What does not lead away from home is held to a landing's least instead of the reserve; a takeoff
    leads away. A stick that only stops the vehicle needs nothing.
    """
    vehicle, body = situation.vehicle, command.body
    if vehicle is None or not command.moves or is_stop(command, situation):
        return None
    is_away = command.takeoff or leads_away(
        body, vehicle, situation.airspace, situation.settings.energy
    )
    reason = _warned(vehicle, is_away) or _short(vehicle, body, is_away, situation)
    return None if reason is None else Refusal(RULE, f"{vehicle.display_name}: {reason}")


def _warned(vehicle: VehicleState, is_away: bool) -> str | None:
    """What the aircraft's own two thresholds say counts, whatever the model says."""
    warning = vehicle.battery_warning.value
    if warning is BatteryWarning.SERIOUS:
        return "the aircraft warns of a seriously low battery: land it, or call it home, now"
    if not is_away or warning is BatteryWarning.NONE:
        return None
    if warning is None:
        return "its app does not tell whether the aircraft warns of its battery: look at the app"
    return "the aircraft warns of a low battery: only what brings it nearer to home is flown"


def _short(vehicle: VehicleState, body: Body, is_away: bool, situation: Situation) -> str | None:
    """What the energy model says; what it cannot say is refused."""
    energy = situation.settings.energy
    uses = consumption(vehicle, situation.airspace, energy)
    if uses is None:
        return (
            "how long its battery lasts is not told, so not whether it comes home: write "
            f'endurance_min = MINUTES under [[vehicles]] serial = "{vehicle.serial}" in site.toml'
        )
    has = vehicle.battery_fraction.value
    if has is None:
        return "its battery's charge is not known, so not whether it comes home: look at the app"
    need = need_of(uses, vehicle, body)
    if need is None:
        return "its place or its home is not known, so not how much battery the way home takes"
    reserve = situation.airspace.airspace.limits.battery_reserve_fraction
    left = reserve if is_away else energy.landing_fraction
    return None if need.whole + left <= has else _text_of_need(body, need, left, has)


def _text_of_need(body: Body, need: Need, left: float, has: float) -> str:
    name = BODY_NAMES[type(body)].replace("_", " ")
    end = f"waypoint {need.at}" if isinstance(body, FlyMission) else "its end"
    flown = f"{_near(need.flown)} % to {end}, " if need.at > 0 else ""
    return (
        f"the {name} needs {_up(need.whole + left)} % of its battery, it has {_down(has)} %: "
        f"{flown}{_near(need.back)} % home from there, and {_near(left)} % to be left; fly less "
        "far, or change the battery"
    )


def _up(fraction: float) -> str:
    return f"{ceil(100.0 * fraction - ROUNDING)}" if isfinite(fraction) else "more than 100"


def _near(fraction: float) -> str:
    return f"{100.0 * fraction:.0f}"


def _down(fraction: float) -> str:
    return f"{floor(100.0 * fraction + ROUNDING)}"
