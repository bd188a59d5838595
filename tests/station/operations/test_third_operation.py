"""A third operation is one entry in `OPERATIONS`: the kernel, the alarms and the audit find it.

Registered in a process of its own, before the kernel is imported, as a real one would be.
"""

import subprocess
import sys
from textwrap import dedent

REGISTER_AND_RUN = dedent(
    """
    from dataclasses import dataclass, replace

    from recon import station
    from recon.model.event import Tick
    from recon.record.audit.audit import AuditEntry
    from recon.site import Site
    from recon.station import operations
    from recon.station.operations.operation import Operation
    from recon.station.state.alarm_book import Condition, Severity
    from recon.station.state.steps import Job, JobKind
    from recon.station.state.steps import on


    @dataclass(frozen=True)
    class PatrolOrdered:
        laps: int


    def ordered(state, event, now_ns):
        return replace(state, next_frame_id=100), (Job(1, PLAN, event.laps),)


    def planned(state, job_id, laps_m, now_ns):
        return replace(state, next_frame_id=state.next_frame_id + laps_m), ()


    def lost(state, *_):
        return state, ()


    PLAN = JobKind("plan_patrol", lambda site: lambda laps: laps * 7, planned, lost, lost)


    def tick(state, now_ns):
        return replace(state, next_frame_id=state.next_frame_id + 1), ()


    def conditions(state):
        if state.next_frame_id > 100:
            yield Condition("patrol", Severity.INFO, "patrol", "", "patrolling")


    def audit(before, event, after, now_ns):
        if isinstance(event, PatrolOrdered):
            yield AuditEntry("patrol.ordered", f"{event.laps} laps")


    PATROL = Operation("patrol", tick, conditions, (on(PatrolOrdered, ordered),), audit)
    operations.OPERATIONS = (*operations.OPERATIONS, PATROL)

    from recon.station.audit.entries import Auditing
    from recon.station.audit.entries import audit as audit_step
    from recon.station.kernel.step import TICK_PARTS, step
    from recon.station.kernel.worker import JobRunner
    from recon.station.state.station import Station

    before = Station()
    after, (job,) = step(before, PatrolOrdered(3), 0)
    _, entries = audit_step(Auditing(), before, PatrolOrdered(3), after, 0)
    after, _ = step(after, JobRunner(Site(name="bare")).run(job), 0)
    after, _ = step(after, Tick(), 0)
    print("parts:", [part.name for part in TICK_PARTS if "patrol" in part.name])
    print("state:", after.next_frame_id)
    print("alarms:", [alarm.condition.text for alarm in after.alarms.alarms.values()])
    print("audit:", [entry.kind for entry in entries])
    """
)


def test_a_third_operation_needs_no_edit_of_the_step() -> None:
    done = subprocess.run(
        [sys.executable, "-c", REGISTER_AND_RUN],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stderr == ""
    assert done.stdout.splitlines() == [
        "parts: ['advancing the patrol']",
        "state: 122",
        "alarms: ['patrolling']",
        "audit: ['patrol.ordered']",
    ]
