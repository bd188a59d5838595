"""The look aside: the imaging drone flies 25 m aside and back, so that a flat scene is decided.

`commands` begins one, `execution` advances it with every tick, `by_itself` begins one for a survey
that allows it. What it shares with the move upwind is in `imager_motion`.
"""

from recon.model.event import LookAsideOrdered
from recon.station.operations.look_aside.commands import audit_entries, order_look_aside
from recon.station.operations.look_aside.conditions import conditions
from recon.station.operations.look_aside.execution import advance
from recon.station.operations.look_aside.light import on_shade
from recon.station.operations.operation import Operation
from recon.station.state.steps import on

LOOK_ASIDE = Operation(
    name="look aside",
    tick=advance,
    conditions=conditions,
    commands=(on(LookAsideOrdered, order_look_aside),),
    audit=audit_entries,
    on_shade=on_shade,
)
