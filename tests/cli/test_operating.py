"""The shell at a real station with simulated drones: done is 0, refused is 1, no way there is 2."""

import json
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.cli.flown import Flown, addresses, flown, run_options
from tests.cli.processes import started


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flown]:
    """Two drones on the ground, on their pads."""
    with flown(tmp_path_factory.mktemp("audit"), 2, "--grounded") as made:
        yield made


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory, here: Flown) -> Path:
    """A short leg above where the first drone stands."""
    (first, *_) = here.recon("status", "--json").json
    position = first["position"]
    waypoints = [
        {
            "latitude_deg": position["latitude_deg"] + north_deg,
            "longitude_deg": position["longitude_deg"],
            "height_above_takeoff_m": 30.0,
            "speed_mps": 3.0,
        }
        for north_deg in (0.0, 0.0002)
    ]
    path = tmp_path_factory.mktemp("mission") / "leg.json"
    path.write_text(json.dumps({"waypoints": waypoints}), encoding="utf-8")
    return path


class TestOnTheGround:
    def test_status_tells_every_vehicle(self, here: Flown) -> None:
        said = here.recon("status")
        assert said.code == 0
        rows = [line for line in said.out.splitlines() if "SIM-" in line]
        assert len(rows) == 2
        assert all("on the ground" in row and "(simulated)" in row for row in rows)

    def test_a_hold_of_what_stands_is_refused_and_all_stop_leaves_it_alone(
        self, here: Flown
    ) -> None:
        held = here.recon("hold", "SIM-1")
        assert held.code == 1
        assert "refused by the rule flying" in held.out
        stopped = here.recon("all-stop")
        assert stopped.code == 0
        assert stopped.out.count("left alone: it is on the ground") == 2

    def test_a_dry_run_tells_what_the_gate_says_and_sends_nothing(
        self, here: Flown, mission: Path
    ) -> None:
        before = here.recon("commands", "--json").json
        refused = here.recon("fly", "SIM-1", mission, "--dry-run")
        assert refused.code == 1
        assert "the gate would refuse it by the rule flying" in refused.out
        assert len(here.recon("commands", "--json").json) == len(before)

    def test_alarms_of_a_quiet_station_are_none_and_unknown_ones_are_said(
        self, here: Flown
    ) -> None:
        said = here.recon("alarms", "--ack", "999")
        assert said.code == 2
        assert "there is no alarm 999" in said.err


class TestReadiness:
    def test_a_checklist_is_told_and_an_override_needs_a_reason(self, here: Flown) -> None:
        told = here.recon("preflight", "SIM-2")
        assert told.code == 0, told.out
        assert told.out.endswith("passed\n")
        assert here.recon("preflight", "SIM-2", "--override", "").code == 1
        overridden = here.recon("preflight", "SIM-2", "--override", "it is a test")
        assert "it is a test" in overridden.out
        shown = here.recon("audit", "show", here.audit, "--kind", "preflight.overridden")
        assert "it is a test" in shown.out

    def test_who_leads_it_is_taken_and_given(self, here: Flown, mission: Path) -> None:
        assert here.recon("release", "SIM-2", "--to", "pilot").code == 0
        refused = here.recon("fly", "SIM-2", mission, "--dry-run")
        assert "rule authority" in refused.out
        assert here.recon("release", "SIM-2", "--to", "guidance").code == 1
        taken = here.recon("take", "SIM-2")
        assert (taken.code, taken.out) == (0, "SIM-2: led by the operator\n")
        assert "rule authority" not in here.recon("fly", "SIM-2", mission, "--dry-run").out

    def test_what_is_heard_is_no_hazard(self, here: Flown) -> None:
        said = here.recon("dismiss", "SIM-2")
        assert said.code == 2
        assert "No hazard area" in said.err

    def test_the_holds_are_switched_and_the_audit_says_so(self, here: Flown) -> None:
        assert here.recon("separation-hold", "off").code == 0
        assert here.get("/api/state")["station"]["separation_hold_on"] is False
        assert here.recon("separation-hold", "on").code == 0
        shown = here.recon("audit", "show", here.audit, "--kind", "separation_hold")
        assert len(shown.out.splitlines()) == 2


class TestWrongUse:
    @pytest.mark.parametrize(
        ("words", "says"),
        [
            (("hold",), "name the vehicles, or say --all"),
            (("land", "SIM-1", "--all"), "name the vehicles, or say --all"),
            (("hold", "SIM-9"), "expected a vehicle's serial or name, got 'SIM-9'"),
            (("fly", "SIM-1", "/nowhere.json"), "/nowhere.json: cannot be read"),
            (("goto", "SIM-1", "41.9"), "LON"),
            (("goto", "SIM-1", "91", "200"), "'LAT': expected degrees from -90 to 90, got 91"),
            (("goto", "SIM-1", "-91", "-93"), "'LAT': expected degrees from -90 to 90, got -91"),
            (("goto", "SIM-1", "41", "200"), "'LON': expected degrees from -180 to 180, got 200"),
            (("hold", "--nonsense"), "--nonsense"),
        ],
    )
    def test_what_cannot_be_meant_is_a_sentence(
        self, here: Flown, words: tuple[str, ...], says: str
    ) -> None:
        said = here.recon(*words)
        assert said.code == 2
        assert says in said.err.replace("\n", " ")

    def test_no_station_is_a_sentence(self, here: Flown) -> None:
        said = here.recon("all-stop", address="http://127.0.0.1:9")
        assert said.code == 2
        assert "nothing was ordered" in said.err

    def test_a_foreign_server_is_a_sentence(self, here: Flown) -> None:
        said = here.recon("all-stop", address=f"http://127.0.0.1:{here.link_port}")
        assert said.code == 2


class TestInFlight:
    def test_a_whole_flight(self, here: Flown, mission: Path) -> None:
        """Take off, be held, be moved, go home; each done when telemetry says so."""
        flying = here.recon("fly", "SIM-1", mission, "--takeoff")
        assert (flying.code, "started" in flying.out) == (0, True), flying.out
        here.until(lambda told: (told[0]["height_above_takeoff_m"]["value"] or 0.0) > 25.0)
        # By the name the site gives it, in any case.
        held = here.recon("hold", "drone 1", "--json")
        assert held.code == 0
        assert held.json[0]["serial"] == "SIM-1"
        assert held.json[0]["phase"] == "done"
        nudged = here.recon("nudge", "SIM-1", "--up", "3")
        assert (nudged.code, "it is there" in nudged.out) == (0, True), nudged.out
        home = here.recon("return", "SIM-1")
        assert home.code == 0, home.out
        landing = here.recon("land", "SIM-1")
        assert (landing.code, "confirmed" in landing.out) == (0, True)
        stopped = here.recon("all-stop", "--json")
        assert {o["serial"]: o["is_left_alone"] for o in stopped.json}["SIM-2"] is True
        kinds = [life["kind"] for life in here.recon("commands", "--json").json]
        assert {"mission", "hover", "nudge", "return_home", "land"} <= set(kinds)


class TestAudit:
    def test_it_tells_who_asked_and_verifies(self, here: Flown) -> None:
        shown = here.recon("audit", "show", here.audit, "--kind", "order.")
        assert shown.code == 0
        assert "api 127.0.0.1" in shown.out
        of_one = here.recon("audit", "show", here.audit, "--vehicle", "SIM-2", "--json")
        assert {json.loads(line)["serial"] for line in of_one.out.splitlines()} == {"SIM-2"}
        verdict = here.recon("audit", "verify", here.audit)
        assert verdict.code == 0
        assert "whole" in verdict.out

    def test_a_changed_file_is_found(self, here: Flown, tmp_path: Path) -> None:
        (path,) = here.audit.glob("*.jsonl")
        copy = tmp_path / path.name
        copy.write_bytes(path.read_bytes().replace(b"SIM-1", b"SIM-3", 1))
        verdict = here.recon("audit", "verify", copy)
        assert verdict.code == 1
        assert "DAMAGED" in verdict.out
        assert here.recon("audit", "verify", copy, "--json").json[0]["is_whole"] is False

    @pytest.mark.parametrize("verb", ["show", "verify"])
    def test_a_file_that_is_not_there_is_a_sentence(self, here: Flown, verb: str) -> None:
        said = here.recon("audit", verb, "/nowhere")
        assert said.code == 2
        assert "/nowhere" in said.err


def test_a_token_is_read_from_a_file_and_never_in_the_audit(tmp_path: Path) -> None:
    secret = "0123456789abcdef-secret"
    token = tmp_path / "token"
    token.write_text(secret + "\n")
    audit = tmp_path / "audit"
    with started(*run_options(audit), "--token-file", str(token)) as station:
        url, link_port = addresses(station)
        here = Flown(station, None, url.partition("/#")[0], link_port, audit)
        refused = here.recon("status")
        assert refused.code == 2
        assert "token" in refused.err
        assert here.recon("status", "--token-file", token).code == 0
        assert here.recon("all-stop", "--token-file", token).out == "there is no vehicle to order\n"
        wrong = here.recon("status", "--token-file", tmp_path / "none")
        assert (wrong.code, "cannot read the token file" in wrong.err) == (2, True)
        assert station.end(signal.SIGTERM) == 0
    (path,) = audit.glob("*.jsonl")
    assert secret not in path.read_text()
    assert '"station.stopped"' in path.read_text().splitlines()[-1]
