"""The fleet return: vehicles fly home in layers, one landing mission each, in waves.

`commands` begins it, `planning` has the worker plan it, `execution` advances it with every tick,
and `progress` reads from telemetry and orders what became of each vehicle. Its state lives in
memory only: after a restart no fleet return continues.
"""

from recon.model.event import FleetReturnOrdered
from recon.station.operations.fleet_return.commands import audit_entries, recall
from recon.station.operations.fleet_return.conditions import conditions
from recon.station.operations.fleet_return.execution import advance
from recon.station.operations.operation import Operation
from recon.station.state.steps import on

FLEET_RETURN = Operation(
    name="fleet return",
    tick=advance,
    conditions=conditions,
    commands=(on(FleetReturnOrdered, recall),),
    audit=audit_entries,
)
