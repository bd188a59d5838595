"""The rules of the gate, in the order they are asked: one file each."""

from collections.abc import Callable

from recon.model.command import Command, Refusal
from recon.safety.rules.altitude_reference import altitude_reference
from recon.safety.rules.authority import authority
from recon.safety.rules.battery import battery
from recon.safety.rules.boundary import boundary
from recon.safety.rules.dji_limits import dji_limits
from recon.safety.rules.finite_numbers import finite_numbers
from recon.safety.rules.flying import flying
from recon.safety.rules.gnss import gnss
from recon.safety.rules.height_zones import height_zones
from recon.safety.rules.home_distance import home_distance
from recon.safety.rules.identified import identified
from recon.safety.rules.keep_out import keep_out
from recon.safety.rules.known_order import known_order
from recon.safety.rules.link_age import link_age
from recon.safety.rules.max_height import max_height
from recon.safety.rules.min_height import min_height
from recon.safety.rules.not_expired import not_expired
from recon.safety.rules.operator_lease import operator_lease
from recon.safety.rules.preflight import preflight
from recon.safety.rules.reachable import reachable
from recon.safety.rules.separation import separation
from recon.safety.rules.speed import speed
from recon.safety.rules.stop_latch import stop_latch
from recon.safety.situation import Situation

Rule = Callable[[Command, Situation], Refusal | None]

RULES: tuple[Rule, ...] = (
    known_order,
    reachable,
    identified,
    not_expired,
    finite_numbers,
    stop_latch,
    authority,
    operator_lease,
    dji_limits,
    altitude_reference,
    flying,
    link_age,
    gnss,
    battery,
    preflight,
    speed,
    home_distance,
    boundary,
    keep_out,
    height_zones,
    min_height,
    max_height,
    separation,
)
