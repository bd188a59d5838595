"""An imaging drone lost in flight: for the others, ground image and sun forecast grow old.

Their flights stay as safe as they were, so an alarm is enough: surveys continue without new shade.
"""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.safety.failsafe.row import ALARM, NO_FIXED, FailsafeRow, FlightFacts, cells

RULE = "imaging_drone_lost"


def find(facts: FlightFacts) -> int | None:
    """Return a lost imaging drone's last telemetry, for all vehicles but imaging drones."""
    if facts.vehicle.serial in facts.station.imager_serials:
        return None
    return facts.station.imager_lost_since_ns


ROW = FailsafeRow(
    condition=FailsafeCondition.IMAGING_DRONE_LOST,
    begins="an imaging drone flies and sent no telemetry for 3 s",
    ends="its telemetry returns",
    reactions=frozenset({Reaction.NOTHING, Reaction.ALARM, Reaction.HOLD, Reaction.RETURN}),
    why_no_other="it is no reason to land the others where they are",
    default=cells(ALARM, ALARM, ALARM, ALARM),
    after_s=30.0,
    alarm_rules=frozenset({RULE}),
    find=find,
    fixed=NO_FIXED,
)
