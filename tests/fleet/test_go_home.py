"""A flight home is followed from mode GO_HOME until its landing ends."""

from dataclasses import replace

from tests.safety.traffic import S, aircraft, at

from recon.fleet.go_home import fold_go_home
from recon.model.units import Stamped
from recon.model.vehicle import FlightMode, VehicleState


def state(mode: FlightMode = FlightMode.GO_HOME, **changes: object) -> VehicleState:
    made = aircraft("B", (200.0, 0.0), 30.0, (-10.0, 0.0, 0.0), mode=mode)
    return replace(made, **changes)  # type: ignore[arg-type]


def test_it_begins_with_the_mode_and_ends_with_another() -> None:
    assert fold_go_home(state(FlightMode.GPS_ATTI), S) is None
    begun = fold_go_home(state(), S)
    assert begun is not None
    assert (begun.since_ns, begun.start_height_m, begun.start_speed_mps) == (S, 30.0, 10.0)
    assert begun.nearest_m is not None
    assert abs(begun.nearest_m - 200.0) < 0.5
    landing = state(FlightMode.AUTO_LANDING, go_home=begun)
    assert fold_go_home(landing, 2 * S) is begun
    assert fold_go_home(replace(landing, is_flying=Stamped(False, S)), 2 * S) is None
    assert fold_go_home(state(FlightMode.GPS_ATTI, go_home=begun), 2 * S) is None


def test_nearer_or_higher_is_progress_and_noise_is_none() -> None:
    begun = fold_go_home(state(), S)
    same = state(go_home=begun, position=Stamped(at(199.5, 0.0), S))
    assert fold_go_home(same, 2 * S) is begun
    nearer = fold_go_home(state(go_home=begun, position=Stamped(at(195.0, 0.0), S)), 2 * S)
    higher = fold_go_home(state(go_home=begun, height_above_takeoff_m=Stamped(32.0, S)), 2 * S)
    for found in (nearer, higher):
        assert found is not None
        assert found.progress_at_ns == 2 * S


def test_it_sets_out_level_once_it_has_braked() -> None:
    begun = fold_go_home(state(), S)
    assert begun is not None
    early = fold_go_home(state(go_home=begun), 5 * S)
    late = fold_go_home(state(go_home=begun), 8 * S)
    assert early is not None
    assert late is not None
    assert early.level_from is None
    assert late.level_from == at(200.0, 0.0)
    hovers = state(go_home=begun, velocity_ned=Stamped(None, S))
    assert fold_go_home(hovers, 8 * S) is begun


def test_what_is_unknown_at_first_is_progress_when_it_comes() -> None:
    blind = fold_go_home(
        state(velocity_ned=Stamped(None, S), position=Stamped(None, S), takeoff_point=None), S
    )
    assert blind is not None
    assert (blind.start_speed_mps, blind.nearest_m) == (0.0, None)
    seen = fold_go_home(state(go_home=blind), 2 * S)
    assert seen is not None
    assert seen.progress_at_ns == 2 * S
    assert fold_go_home(state(go_home=seen, position=Stamped(None, S)), 3 * S) is not None
