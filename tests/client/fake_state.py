"""States of a fake station, built from the API's models.

Keys the client does not read may be missing.
"""

from typing import Any

from recon.api import schema

RUN_STARTED_NS = 1_000_000_000_000


def vehicle(serial: str | None = "SIM-1", age_s: float | None = 0.05) -> schema.VehicleView:
    """A flying vehicle, all values with one age."""
    number = schema.AgedNumber(value=12.0, age_s=age_s)
    return schema.VehicleView.model_construct(
        number=1,
        serial=serial,
        link_id=1,
        name="one",
        model="M300",
        is_simulated=True,
        is_imager=False,
        authority=schema.AuthorityView(
            holder="operator", holder_name="", age_s=None, reason="default"
        ),
        preflight_override=None,
        steering=None,
        staleness="live",
        telemetry_age_s=age_s,
        is_flying=schema.AgedFlag(value=True, age_s=age_s),
        position=schema.PositionView(latitude_deg=41.9, longitude_deg=-93.6, age_s=age_s),
        height_above_takeoff_m=number,
        reported_altitude_m=number,
        velocity_ned=schema.VelocityView(north_mps=1.0, east_mps=0.0, down_mps=0.0, age_s=age_s),
        attitude=schema.AttitudeView(yaw_deg=0.0, pitch_deg=0.0, roll_deg=0.0, age_s=age_s),
        battery_fraction=number,
        battery_warning=schema.AgedText(value="none", age_s=age_s),
        gnss_satellite_count=number,
        gnss_signal_level=number,
        wind_level=number,
        flight_mode=schema.AgedText(value="gps_atti", age_s=age_s),
        mission_id=schema.AgedNumber(value=None, age_s=None),
        camera_state=schema.AgedText(value=None, age_s=None),
        waypoint_altitude="takeoff",
        conflict_link_ids=[],
        track=[(-93.6, 41.9)],
        frame=None,
    )


def command(number: int = 1, phase: schema.PhaseName = "sent") -> schema.CommandView:
    """A hover in one phase."""
    return schema.CommandView.model_construct(
        id=number,
        kind="hover",
        serial="SIM-1",
        vehicle_name="one",
        issued_by="test",
        age_s=1.0,
        phase=phase,
        is_final=False,
        note="",
        times_sent=1,
        takeoff=False,
        sent_altitudes=None,
        part=None,
        repairs=[],
        history=[schema.PhaseView(phase=phase, age_s=1.0, note="")],
    )


def state(
    uptime_ns: int = 5_000_000_000,
    run_started_ns: int = RUN_STARTED_NS,
    *,
    vehicles: tuple[schema.VehicleView, ...] = (),
    commands: tuple[schema.CommandView, ...] = (),
) -> schema.StationState:
    """A complete state of one run of the station."""
    return schema.StationState.model_construct(
        time_ns=run_started_ns + uptime_ns,
        station=schema.StationView.model_construct(uptime_s=uptime_ns / 1e9),
        site=None,
        vehicles=list(vehicles),
        links=[],
        commands=list(commands),
        alarms=[],
        ground_image=None,
        fleet_return=None,
    )


def state_text(*parts: Any, **more: Any) -> str:
    """A state as JSON text."""
    return state(*parts, **more).model_dump_json()
