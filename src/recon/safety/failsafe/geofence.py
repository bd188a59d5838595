"""Geofence: about to leave the boundary or to enter a keep-out zone, or beyond it already.

The watchdog `fences` finds it and gives the hold in its own time; a cell only decides whether it
may. A landing or return is not stopped.
"""

from recon.model.failsafe_matrix import Activity, FailsafeCondition, Reaction
from recon.safety.failsafe.row import ALARM, FailsafeRow, cells, hold

ROW = FailsafeRow(
    condition=FailsafeCondition.GEOFENCE,
    begins="about to leave the boundary or to enter a keep-out zone",
    ends="it turns away",
    reactions=frozenset({Reaction.ALARM, Reaction.HOLD}),
    why_no_other="the watchdog holds or only raises its alarm",
    default=cells(hold(), hold(), hold(), ALARM),
    after_s=0.0,
    alarm_rules=frozenset(),
    find=None,
    fixed={Activity.RETURNING: "what lands or returns is not stopped at a fence"},
)
