"""The station's own times and limits, each with its reason."""

from dataclasses import dataclass, field

from recon.detection import DetectionSettings
from recon.fleet.settings import FleetSettings
from recon.forecast import ForecastSettings
from recon.guidance.steering import SteeringSettings
from recon.model.failsafe_matrix import FailsafeMatrix
from recon.model.mission import DJI
from recon.safety import SafetySettings
from recon.safety.failsafe import DEFAULT_MATRIX
from recon.station.state.setpoint_stream import StreamSettings


@dataclass(frozen=True, slots=True)
class RestartSettings:
    """Limits for what a restart restores; times in seconds."""

    forgotten_after_s: float = 5_400.0
    """No aircraft of this size flies for an hour; half an hour more for a clock that was set."""

    settle_s: float = 10.0
    """Time after a restart in which hazard areas of restored vehicles raise no alarm and hold no
    other vehicle: apps reconnect within seconds, and each vehicle that reports again is close to
    the hazard areas of those about to report. The gate counts these areas from the start."""

    fastest_mps: float = DJI.fastest_mps
    fastest_climb_mps: float = 10.0
    place_error_m: float = 30.0
    height_error_m: float = 5.0
    battery_gain_fraction: float = 0.03
    """A battery in flight only discharges; a gain beyond its gauge error means that it was replaced
    on the ground."""


@dataclass(frozen=True, slots=True)
class FlightAlarmSettings:
    """What a vehicle in flight must not do, and for how long it must last to be an alarm."""

    gnss_s: float = 2.0
    """Shortest duration of a poor fix: under trees and at takeoff it is poor for a moment."""
    height_s: float = 1.0
    max_tilt_deg: float = 45.0
    """DJI's aircraft lean by 25 to 35 degrees at most, in sport mode by 42."""
    tilt_s: float = 0.5
    max_descent_mps: float = 9.0
    """Fastest expected descent: vehicles sink at 3 to 6 m/s, the fastest at 8."""
    descent_s: float = 0.3
    slow_answer_s: float = 1.0
    """Longest time from an order's sending to its acknowledgment: apps acknowledge when they have
    read it, so this is the link's round trip. At 15 m/s it is 15 m."""


@dataclass(frozen=True, slots=True)
class FailsafeSettings:
    """Limits of the failsafe matrix's station conditions, and how reactions are ordered; times in
    seconds."""

    period_s: float = 0.1
    lingers_s: float = 3.0
    """A condition that is back within this is the same occurrence: no second reaction."""
    retry_s: float = 1.0
    tries: int = 5
    """A reaction that the gate refused is ordered again: telemetry comes back within seconds."""

    restart_settles_s: float = 3.0
    """What a vehicle shows in its first telemetry after a restart, two extended packets long, is
    from before it: the operator knows it, or has decided about it."""

    late_step_s: float = 0.5
    """Ten ticks missed: sticks are late by as much, and an aircraft hovers below 5 Hz."""
    late_within_s: float = 10.0
    """One such gap happens; a second one within this is a load that stays."""
    suspended_s: float = 1.0
    """The gap from which on the station counts as suspended, as in the driver."""
    late_lasts_s: float = 5.0

    operator_stays_s: float = 30.0
    """A client connected this long is a console or a program; a command of the shell is shorter."""
    operator_gone_s: float = 10.0
    """A page that is opened again, or a network that changes, is back within this."""


@dataclass(frozen=True, slots=True)
class StationSettings:
    """Times in seconds."""

    fleet: FleetSettings = field(default_factory=FleetSettings)
    safety: SafetySettings = field(default_factory=SafetySettings)
    restart: RestartSettings = field(default_factory=RestartSettings)
    flight_alarms: FlightAlarmSettings = field(default_factory=FlightAlarmSettings)
    failsafe: FailsafeSettings = field(default_factory=FailsafeSettings)
    failsafe_matrix: FailsafeMatrix = DEFAULT_MATRIX
    detection: DetectionSettings = field(default_factory=DetectionSettings)
    forecast: ForecastSettings = field(default_factory=ForecastSettings)

    order_expiry_s: float = 5.0
    """An order not sent by then may no longer fit what the operator sees."""

    lease_absent_s: float = 60.0
    """A tablet that changes the network or a page that is loaded again is back by then; a vehicle
    in the air must not wait longer for an absent person."""

    stop_waits_s: float = 30.0
    """A hover refused because telemetry is stale or the connection lost waits this long for
    telemetry: a stop must not be lost in a gap."""

    takeoff_stop_s: float = 30.0
    """A stop follows a takeoff under way this long: a mission's upload and start, motors and climb
    take 20 s and some seconds for many waypoints (`mission_takeoff_s`)."""

    emergency_repeat_s: float = 0.7
    emergency_repeats: int = 3
    """Decisions on the ICD, 16: every 0.7 s, three at most, until telemetry confirms."""

    emergency_answer_s: float = 3.5
    """Time to confirm: after the last repeat little more than a second is left for an effect."""

    emergency_confirm_s: float = 10.0
    """A hover that has begun: from 15 m/s an aircraft needs 6 s to stand still."""

    mission_takeoff_s: float = 12.0
    """A mission that is seen to take off for it takes so much longer to show its mode: motors and
    climb. When missions start at the latest is the gate's (`PredictionSettings`)."""

    mode_lasts_s: float = 1.0
    """A sign of the pilot or a failsafe that an app may show in passing counts after this: three
    reports of the mode at its usual rate."""

    undecided_s: float = 30.0
    """An order whose vehicle stays in an ambiguous mode this long has failed."""

    parts_gap_s: float = 3.0
    """Longest telemetry gap before a next part: in a longer one its pilot may have flown it."""

    telemetry_lost_s: float = 600.0
    """Time without telemetry after which the outcome of an order stays unknown."""

    camera_confirm_s: float = 8.0
    stick_confirm_s: float = 2.0

    stick_to_hold_s: float = 1.0
    """Time from a neutral setpoint to the hold: a client that steers by single sticks sends the
    next one within this, and mode changes cost an app some tenths of a second."""

    neutral_setpoint_waits_s: float = 3.0
    """Longest wait for the mode after a stick's time; later, nothing applies the setpoint."""

    steering: SteeringSettings = field(default_factory=SteeringSettings)
    streams: StreamSettings = field(default_factory=StreamSettings)

    orders_kept: int = 200
    alarms_kept: int = 200
    app_messages_kept: int = 8
    """Unseen messages of one app: a talkative app must not push out what matters."""

    frames_kept: int = 16
    """The newest frame of this many vehicles: 25 MB each at most."""

    sun_time_ahead_s: float = 0.0
    """Added to the computer's clock for the sun's position: simulated drones fly by day at any
    hour."""

    imaging_trouble_after_s: float = 3.0
    """A first frame comes before the first telemetry, and one lost frame is no problem."""

    low_battery_fraction: float = 0.25
    serious_battery_fraction: float = 0.10
    """Limit in flight; the aircraft's own warnings also count, whichever comes first."""

    serial_wait_s: float = 2.0
    """Extended telemetry, with the serial, comes at 1 to 2 Hz: a link in flight without it for
    longer is an unidentified vehicle."""

    first_telemetry_s: float = 3.0
    """A vehicle known by its serial alone, without core telemetry this long, is unseen."""

    landing_wait_s: float = 8.0
    """Time after which a landing that waits for confirmation needs its pilot (decisions, 17)."""

    pose_history_samples: int = 50
    """Five seconds of the imaging drone's telemetry, to look up the pose of a late frame."""
