package recon.aircraft

import recon.geo.LatLon

/** Metres per second; [downMps] positive down. */
data class VelocityNed(val northMps: Double, val eastMps: Double, val downMps: Double)

/** Degrees: yaw 0 north, clockwise; pitch positive nose up; roll positive right side down. */
data class Attitude(val yawDeg: Double, val pitchDeg: Double, val rollDeg: Double)

/** Flight modes with their numbers in telemetry (docs/icd.md, "ExtendedTelemetry"). */
enum class FlightMode(val wireValue: Int) {
    MANUAL(0),
    ATTI(1),
    GPS_ATTI(3),
    ASSISTED_TAKEOFF(7),
    AUTO_TAKEOFF(8),
    AUTO_LANDING(9),
    WAYPOINT(10),
    GO_HOME(11),
    JOYSTICK(12),
    ACTIVE_TRACK(16),
    TAP_FLY(17),
    SPORT(18),
    NOVICE(19),
    CONFIRM_LANDING(21),
    TRIPOD(23),
    MOTORS_JUST_STARTED(25),
    OTHER(255),
    ;

    /** Whether the aircraft is between the start of its motors and its hover after takeoff. */
    val isTakeoff: Boolean get() = this in setOf(ASSISTED_TAKEOFF, AUTO_TAKEOFF, MOTORS_JUST_STARTED)
}

enum class BatteryWarning(val wireValue: Int) { NONE(0), LOW(1), SERIOUS(2) }

enum class CameraState(val wireValue: Int) { NOT_CONNECTED(0), FEED_OFF(1), FEED_ON(2) }

/** What the aircraft does when it loses its controller; set in the aircraft, read only. */
enum class Failsafe { HOVER, LAND, GO_HOME, UNKNOWN }

/** Whether an aircraft has a function, as it reports itself: never assumed from its name. */
enum class Capability { SUPPORTED, UNSUPPORTED, UNKNOWN }

/** What the aircraft reports that it can do. */
data class Capabilities(
    val waypointMissions: Capability = Capability.UNKNOWN,
    val virtualStick: Capability = Capability.UNKNOWN,
    val camera: Capability = Capability.UNKNOWN,
    /** Height above takeoff to which it climbs before it flies home; null when not reported. */
    val goHomeHeightM: Double? = null,
    val failsafe: Failsafe = Failsafe.UNKNOWN,
)

/**
 * The newest state of the aircraft. Null means that the aircraft has not reported the value.
 *
 * Heights are above its takeoff point, barometric. [takeoffAltitudeM] is the WGS84 altitude of that
 * point as the aircraft knows it, off by tens of metres.
 */
data class AircraftState(
    /** When the aircraft last reported, in nanoseconds of the session's clock. */
    val updatedNs: Long,
    val serial: String?,
    val isSimulated: Boolean = false,
    val isFlying: Boolean,
    val flightMode: FlightMode,
    val position: LatLon?,
    val heightAboveTakeoffM: Double,
    val takeoffAltitudeM: Double?,
    val velocity: VelocityNed,
    val attitude: Attitude,
    val gnssSatelliteCount: Int = 0,
    val gnssSignalLevel: Int? = null,
    val isAtMaxHeight: Boolean = false,
    val isAtMaxDistance: Boolean = false,
    val batteryPercent: Int? = null,
    val batteryWarning: BatteryWarning = BatteryWarning.NONE,
    val windLevel: Int? = null,
    val cameraState: CameraState = CameraState.NOT_CONNECTED,
    /** It waits at 0.3 m until the app confirms that the ground is fit to land on. */
    val needsLandingConfirmation: Boolean = false,
    val capabilities: Capabilities = Capabilities(),
    val facts: AircraftFacts = AircraftFacts(),
) {
    /** Whether it stands on the ground with no takeoff under way. */
    val isOnGround: Boolean get() = !isFlying && !flightMode.isTakeoff
}
