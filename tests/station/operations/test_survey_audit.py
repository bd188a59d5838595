"""What the audit tells of surveys: who said what, and what they became by themselves."""

from tests.station.surveyed_world import SURVEY_ID, SurveyedWorld, asked, surveyed_world

from recon.model.event import Event
from recon.model.survey import SurveyPhase
from recon.record.audit import AuditEntry
from recon.station.audit.entries import Auditing, audit
from recon.station.state.station import Station


def audited(world: SurveyedWorld) -> list[AuditEntry]:
    """Collect what the audit is told from now on, of surveys and of who leads."""
    entries: list[AuditEntry] = []
    memory = Auditing()

    def observe(before: Station, after: Station, event: Event) -> None:
        nonlocal memory
        memory, told = audit(memory, before, event, after, world.driver.now_ns)
        entries.extend(e for e in told if e.kind.startswith(("survey.", "authority.")))

    world.driver.observe = observe
    return entries


def test_every_word_is_told_with_who_said_it() -> None:
    world = surveyed_world()
    entries = audited(world)
    world.asks()
    world.starts("SIM-1", takeoff=True)
    world.runs(5.0)
    world.pauses()
    world.aborts()
    told = [(entry.kind, entry.by) for entry in entries]
    assert told == [
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


def test_a_hold_on_the_way_home_is_told_as_what_it_is() -> None:
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


def test_a_refused_word_is_told_with_its_reason() -> None:
    world = surveyed_world()
    entries = audited(world)
    world.asks()
    world.starts("SIM-9")
    (refused,) = [entry for entry in entries if entry.kind == "survey.refused"]
    assert refused.by == "ann"
    assert refused.details["asked"] == "started"
    assert "SIM-9 is not known" in refused.details["reason"]


def test_one_that_cannot_be_flown_is_told() -> None:
    world = surveyed_world()
    entries = audited(world)
    world.asks(asked(speed_mps=14.0))
    assert [entry.kind for entry in entries] == ["survey.asked", "survey.is_refused"]


def test_what_it_becomes_by_itself_is_told() -> None:
    world = surveyed_world(max_height_m=30.0, height_m=20.0, go_home_height_m=25.0)
    entries = audited(world)
    world.asks()
    world.starts("SIM-1")
    world.runs(10.0)
    assert entries[-2].kind == "survey.is_paused" or entries[-1].kind == "survey.is_paused"
    authorities = [e.details["holder"] for e in entries if e.kind == "authority.taken"]
    assert authorities == ["guidance", "operator"]
