"""Commands at a real station with simulated drones: 0 done, 1 refused, 2 wrong use."""

import json
import shlex
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.cli.processes import started
from tests.cli.station_process import StationProcess, addresses, run_options, station_process
from tests.persons import user

from recon.model.person import Role
from recon.record.files.users_file import change_users
from recon.station.host.http_servers import local_person

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def station(tmp_path_factory: pytest.TempPathFactory) -> Iterator[StationProcess]:
    """Two drones on the ground, on their pads."""
    with station_process(tmp_path_factory.mktemp("audit"), 2, "--grounded") as made:
        yield made


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory, station: StationProcess) -> Path:
    """A short leg above the first drone."""
    (first, *_) = station.recon("status", "--json").json
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
    def test_status_shows_every_vehicle(self, station: StationProcess) -> None:
        result = station.recon("status")
        assert result.code == 0
        rows = [line for line in result.out.splitlines() if "SIM-" in line]
        assert len(rows) == 2
        assert all("on the ground" in row and "(simulated)" in row for row in rows)

    def test_a_hold_on_the_ground_is_refused_and_all_stop_sends_nothing(
        self, station: StationProcess
    ) -> None:
        held = station.recon("hold", "SIM-1")
        assert held.code == 1
        assert "refused (flying): " in held.out
        stopped = station.recon("all-stop")
        assert stopped.code == 0
        assert stopped.out.count(": on the ground, nothing sent") == 2
        assert station.recon("release-stop", "--all").code == 0

    def test_an_all_stop_stays_in_force_until_it_is_released(
        self, station: StationProcess, mission: Path
    ) -> None:
        assert station.recon("all-stop").code == 0
        assert f"ALL STOP by {local_person().label}" in station.recon("status").out
        refused = station.recon("fly", "SIM-1", mission, "--takeoff", "--dry-run")
        assert "would be refused (stop_latch): " in refused.out
        assert station.recon("release-stop").code == 2
        assert station.recon("release-stop", "SIM-1").code == 0
        assert "released: SIM-1;" in station.recon("status").out
        assert station.recon("release-stop", "--all").code == 0
        assert "ALL STOP" not in station.recon("status").out
        again = station.recon("release-stop", "--all")
        assert (again.code, "refused (stop_latch)" in again.out) == (1, True)

    def test_a_side_step_without_its_imaging_drone_is_refused(
        self, station: StationProcess
    ) -> None:
        result = station.recon("side-step")
        assert result.code != 0
        assert "refused (side_step): the imaging drone SIM-IMAGER is not connected" in result.out

    def test_a_relief_by_what_is_no_imaging_drone_is_refused(self, station: StationProcess) -> None:
        result = station.recon("relieve", "SIM-1", "SIM-2")
        assert result.code != 0
        assert "refused (imager_relief): SIM-1 is no imaging drone of the site" in result.out
        survey = station.recon(
            "survey",
            "create",
            "south-east field",
            "--height",
            "45",
            "--relief",
            "--spare",
            "SIM-1",
        )
        assert survey.code != 0
        assert "is no imaging drone of the site; available: SIM-IMAGER" in survey.out

    def test_a_temporary_zone_is_added_listed_and_ended(self, station: StationProcess) -> None:
        (first, *_) = station.recon("status", "--json").json
        place = first["position"]
        at = f"{place['latitude_deg'] + 0.002:.6f},{place['longitude_deg']:.6f}"
        person = ("--kind", "person", "--reason", "checks a sprinkler")
        circle = ("--at", at, "--radius-m", "20")
        added = station.recon("zone", "add", *person, *circle, "--minutes", "10")
        assert added.code == 0
        assert added.out == (
            "zone 1 is in force: person 1 (temporary), from 0 m to 30 m above ground, ends in "
            "10 min\n"
        )
        listed = station.recon("zone", "list")
        assert "person  radius 20 m" in listed.out
        assert "1 temporary zones in force" in listed.out
        assert station.recon("zone", "list", "--json").json[0]["radius_m"] == 20.0
        assert station.recon("zone", "end", "1").out == "zone 1 has ended (audited)\n"
        again = station.recon("zone", "end", "1")
        assert (again.code, "no temporary zone 1 is in force" in again.out) == (1, True)
        large = station.recon("zone", "add", *person, "--at", at, "--radius-m", "5000")
        assert (large.code, "1 to 2000 m are possible" in large.out) == (1, True)
        for wrong in (
            (),
            ("--at", at),
            ("--at", "here", "--radius-m", "9"),
            (*circle, "--corner", at),
        ):
            assert station.recon("zone", "add", *person, *wrong).code == 2

    def test_the_guides_zone_commands_work(self, station: StationProcess) -> None:
        guide = (ROOT / "docs/how-to/keep-a-place-clear.md").read_text(encoding="utf-8")
        lines = [line for line in guide.splitlines() if line.startswith("recon zone ")]
        assert [line.split()[2] for line in lines] == ["add", "add", "list", "end"]
        for line in lines[:-1]:
            assert station.recon(*shlex.split(line)[1:]).code == 0, line
        drawn = station.recon("zone", "list", "--json").json
        assert [zone["kind"] for zone in drawn] == ["person", "tractor"]
        for zone in drawn:
            assert station.recon("zone", "end", str(zone["id"])).code == 0

    def test_a_dry_run_prints_the_refusal_and_sends_nothing(
        self, station: StationProcess, mission: Path
    ) -> None:
        before = station.recon("commands", "--json").json
        refused = station.recon("fly", "SIM-1", mission, "--dry-run")
        assert refused.code == 1
        assert "would be refused (flying): " in refused.out
        assert len(station.recon("commands", "--json").json) == len(before)

    def test_acknowledging_an_unknown_alarm_is_an_error(self, station: StationProcess) -> None:
        result = station.recon("alarms", "--ack", "999")
        assert result.code == 1
        assert "Alarm 999 not found" in result.err


class TestReadiness:
    def test_a_checklist_is_shown_and_an_override_needs_a_reason(
        self, station: StationProcess
    ) -> None:
        checklist = station.recon("preflight", "SIM-2")
        assert checklist.code == 0, checklist.out
        assert checklist.out.endswith("passed\n")
        assert "telemetry lost  hold after 3 s  hold after 3 s  alarm  alarm\n" in checklist.out
        assert "failsafe matrix: default\n" in checklist.out
        assert station.recon("preflight", "SIM-2", "--override", "").code == 1
        overridden = station.recon("preflight", "SIM-2", "--override", "it is a test")
        assert "it is a test" in overridden.out
        assert "it is a test" in station.audited("preflight.overridden")[-1]

    def test_control_authority_is_taken_and_released(
        self, station: StationProcess, mission: Path
    ) -> None:
        assert station.recon("release", "SIM-2", "--to", "pilot").code == 0
        refused = station.recon("fly", "SIM-2", mission, "--dry-run")
        assert "refused (authority)" in refused.out
        assert station.recon("release", "SIM-2", "--to", "guidance").code == 1
        taken = station.recon("take", "SIM-2")
        assert (taken.code, taken.out) == (0, "SIM-2: operator control\n")
        assert "refused (authority)" not in station.recon("fly", "SIM-2", mission, "--dry-run").out

    def test_a_connected_vehicle_has_no_hazard_area(self, station: StationProcess) -> None:
        result = station.recon("dismiss", "SIM-2")
        assert result.code == 1
        assert "No hazard area" in result.err

    def test_separation_holds_are_switched_and_audited(self, station: StationProcess) -> None:
        assert station.recon("separation-hold", "off").code == 0
        assert station.get("/api/state")["station"]["separation_hold_on"] is False
        assert station.recon("separation-hold", "on").code == 0
        assert len(station.audited("separation_hold", entries=2)) == 2


class TestWrongUse:
    @pytest.mark.parametrize(
        ("words", "sentence"),
        [
            (("hold",), "Name the vehicles or use --all"),
            (("land", "SIM-1", "--all"), "Name the vehicles or use --all"),
            (("hold", "SIM-9"), "expected a vehicle's serial or name, got 'SIM-9'"),
            (("fly", "SIM-1", "/nowhere.json"), "/nowhere.json: cannot be read"),
            (("goto", "SIM-1", "41.9"), "LON"),
            (("goto", "SIM-1", "91", "200"), "'LAT': expected degrees from -90 to 90, got 91"),
            (("goto", "SIM-1", "-91", "-93"), "'LAT': expected degrees from -90 to 90, got -91"),
            (("goto", "SIM-1", "41", "200"), "'LON': expected degrees from -180 to 180, got 200"),
            (("hold", "--nonsense"), "--nonsense"),
        ],
    )
    def test_wrong_use_is_one_sentence(
        self, station: StationProcess, words: tuple[str, ...], sentence: str
    ) -> None:
        result = station.recon(*words)
        assert result.code == 2
        assert sentence in result.err.replace("\n", " ")

    def test_an_unreachable_station_is_one_sentence(self, station: StationProcess) -> None:
        result = station.recon("all-stop", address="http://127.0.0.1:9")
        assert result.code == 1
        assert "nothing was ordered" in result.err

    def test_another_kind_of_server_is_an_error(self, station: StationProcess) -> None:
        result = station.recon("all-stop", address=f"http://127.0.0.1:{station.link_port}")
        assert result.code == 1


class TestInFlight:
    def test_a_whole_flight(self, station: StationProcess, mission: Path) -> None:
        """Take off, hold, nudge, return to home; each confirmed by telemetry."""
        flying = station.recon("fly", "SIM-1", mission, "--takeoff")
        assert (flying.code, "started" in flying.out) == (0, True), flying.out
        station.until(
            lambda vehicles: (vehicles[0]["height_above_takeoff_m"]["value"] or 0.0) > 25.0
        )
        # By its name in site.toml, in any case.
        held = station.recon("hold", "drone 1", "--json")
        assert held.code == 0
        assert held.json[0]["serial"] == "SIM-1"
        assert held.json[0]["phase"] == "done"
        nudged = station.recon("nudge", "SIM-1", "--up", "3")
        assert (nudged.code, "arrived" in nudged.out) == (0, True), nudged.out
        home = station.recon("return", "SIM-1")
        assert home.code == 0, home.out
        landing = station.recon("land", "SIM-1")
        assert (landing.code, "confirmed" in landing.out) == (0, True)
        stopped = station.recon("all-stop", "--json")
        assert {o["serial"]: o["is_left_alone"] for o in stopped.json}["SIM-2"] is True
        kinds = [life["kind"] for life in station.recon("commands", "--json").json]
        assert {"mission", "hover", "nudge", "return_home", "land"} <= set(kinds)


class TestAudit:
    def test_it_names_the_client_and_verifies(self, station: StationProcess) -> None:
        assert any(local_person().label in line for line in station.audited("order."))
        of_one = station.recon("audit", "show", station.audit, "--vehicle", "SIM-2", "--json")
        assert {json.loads(line)["serial"] for line in of_one.out.splitlines()} == {"SIM-2"}
        verdict = station.recon("audit", "verify", station.audit)
        assert verdict.code == 0
        assert "intact" in verdict.out

    def test_a_changed_file_is_detected(self, station: StationProcess, tmp_path: Path) -> None:
        (path,) = station.audit.glob("*.jsonl")
        copy = tmp_path / path.name
        copy.write_bytes(path.read_bytes().replace(b"SIM-1", b"SIM-3", 1))
        verdict = station.recon("audit", "verify", copy)
        assert verdict.code == 1
        assert "DAMAGED" in verdict.out
        assert station.recon("audit", "verify", copy, "--json").json[0]["is_whole"] is False

    @pytest.mark.parametrize("verb", ["show", "verify"])
    def test_a_missing_file_is_one_sentence(self, station: StationProcess, verb: str) -> None:
        result = station.recon("audit", verb, "/nowhere")
        assert result.code == 2
        assert "/nowhere" in result.err


def test_a_token_is_read_from_a_file_and_not_audited(tmp_path: Path) -> None:
    secret = "0123456789abcdef-secret"
    token, users, audit = tmp_path / "token", tmp_path / "users.toml", tmp_path / "audit"
    token.write_text(secret + "\n")
    change_users(users, lambda known: [user("anna", Role.PILOT, secret)])
    shared = ("--https-host", "127.0.0.1", "--https-port", "0", "--users", str(users))
    with started(*run_options(audit), *shared) as process:
        _, link_port = addresses(process)
        url = process.line_with("console for other computers").rpartition(" ")[2]
        fingerprint = process.line_with("certificate SHA-256").rpartition(" ")[2]
        pinned = f"{url}/#fingerprint={fingerprint}"
        station = StationProcess(process, None, pinned, link_port, audit)
        refused = station.recon("status")
        assert refused.code == 1
        assert "token missing" in refused.err
        assert "--token-file FILE" in refused.err
        unpinned = station.recon("status", "--token-file", token, address=url)
        assert (unpinned.code, "RECON_FINGERPRINT" in unpinned.err) == (1, True)
        assert station.recon("status", "--token-file", token).code == 0
        assert station.recon("all-stop", "--token-file", token).out == "no vehicles to command\n"
        released = station.recon("release-stop", "--all", "--token-file", token)
        assert (released.code, "this needs operator" in released.err) == (1, True)
        wrong = station.recon("status", "--token-file", tmp_path / "none")
        assert (wrong.code, "cannot read the token file" in wrong.err) == (2, True)
        assert process.end(signal.SIGTERM) == 0
    (path,) = audit.glob("*.jsonl")
    assert secret not in path.read_text()
    assert '"by":"anna (127.0.0.1)"' in path.read_text()
    assert '"station.stopped"' in path.read_text().splitlines()[-1]
