"""Separation: two vehicles, or one and a hazard area, come too near.

The watchdog `separation` finds it, chooses whom to hold, and when; a cell only decides whether a
vehicle in that activity may be held. One on the route home is held last. The switch for all holds
stays (`recon separation-hold`).
"""

from recon.model.failsafe_matrix import FailsafeCondition, Reaction
from recon.safety.failsafe.row import NO_FIXED, FailsafeRow, cells, hold

ROW = FailsafeRow(
    condition=FailsafeCondition.SEPARATION,
    begins="two will come too near, or one too near a lost vehicle",
    ends="they keep apart",
    reactions=frozenset({Reaction.ALARM, Reaction.HOLD}),
    why_no_other="the watchdog holds or only raises its alarm",
    default=cells(hold(), hold(), hold(), hold()),
    after_s=0.0,
    alarm_rules=frozenset(),
    find=None,
    fixed=NO_FIXED,
)
