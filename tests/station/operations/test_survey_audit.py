"""Audit entries of surveys: commands with their user, and changes of phase."""

from tests.station.surveyed_world import SURVEY_ID, SurveyedWorld, asked, field, surveyed_world

from recon.model.airspace import HeightDatum, Zone, ZoneKind
from recon.model.survey import SurveyPhase
from recon.record.audit.audit import AuditEntry
from recon.station.audit.entries import Auditing, audit
from recon.station.state.steps import StepTaken


def audited(world: SurveyedWorld) -> list[AuditEntry]:
    """Collect the audit's entries from now on, of surveys and of control authority."""
    entries: list[AuditEntry] = []
    memory = Auditing()

    def observe(step: StepTaken) -> None:
        nonlocal memory
        memory, new = audit(memory, step.before, step.event, step.after, step.now_ns)
        entries.extend(e for e in new if e.kind.startswith(("survey.", "authority.")))

    world.driver.observe = observe
    return entries


def test_every_command_is_audited_with_its_user() -> None:
    world = surveyed_world()
    entries = audited(world)
    world.asks()
    world.starts("SIM-1", takeoff=True)
    world.runs(5.0)
    world.pauses()
    world.aborts()
    audited_by = [(entry.kind, entry.by) for entry in entries]
    assert audited_by == [
        ("survey.asked", "ann"),
        ("survey.is_created", "station"),
        ("survey.started", "ann"),
        ("authority.taken", "ann"),
        ("survey.paused", "bob"),
        ("authority.taken", "bob: survey field paused"),
        ("survey.aborted", "bob"),
    ]
    started = entries[2]
    assert started.details == {"id": SURVEY_ID, "serials": ["SIM-1"], "takeoff": True}


def test_a_stop_after_the_end_is_audited_as_a_hold() -> None:
    world = surveyed_world()
    entries = audited(world)
    world.asks()
    world.starts("SIM-1")
    assert world.runs_until(SurveyPhase.DONE, 400.0)
    world.runs(3.0)
    world.aborts()
    assert [entry.kind for entry in entries][-3:] == [
        "survey.is_done",
        "survey.held",
        "authority.taken",
    ]
    assert world.phase() is SurveyPhase.DONE


def test_a_refused_command_is_audited_with_its_reason() -> None:
    world = surveyed_world()
    entries = audited(world)
    world.asks()
    world.starts("SIM-9")
    (refused,) = [entry for entry in entries if entry.kind == "survey.refused"]
    assert refused.by == "ann"
    assert refused.details["asked"] == "started"
    assert "SIM-9 is unknown" in refused.details["reason"]


def test_a_survey_that_cannot_be_flown_is_audited() -> None:
    world = surveyed_world()
    entries = audited(world)
    world.asks(asked(speed_mps=14.0))
    assert [entry.kind for entry in entries] == ["survey.asked", "survey.is_refused"]


def test_a_change_of_phase_without_a_command_is_audited() -> None:
    wires = Zone("wires", ZoneKind.HEIGHT, field(), None, 30.0, HeightDatum.GROUND)
    world = surveyed_world(zones=(wires,))
    entries = audited(world)
    world.asks()
    world.starts("SIM-1")
    world.runs(10.0)
    assert entries[-2].kind == "survey.is_paused" or entries[-1].kind == "survey.is_paused"
    authorities = [e.details["holder"] for e in entries if e.kind == "authority.taken"]
    assert authorities == ["guidance", "operator"]
