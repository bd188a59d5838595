package recon.msdk5

import recon.aircraft.AircraftFacts
import recon.aircraft.AircraftState
import recon.aircraft.Attitude
import recon.aircraft.BatteryWarning
import recon.aircraft.CameraState
import recon.aircraft.Capabilities
import recon.aircraft.Capability
import recon.aircraft.Failsafe
import recon.aircraft.FlightMode
import recon.aircraft.VelocityNed
import recon.geo.LatLon

/** DJI's flight modes by name; those that are not listed are reported as other. */
private val FLIGHT_MODES = mapOf(
    "MANUAL" to FlightMode.MANUAL,
    "ATTI" to FlightMode.ATTI,
    "ATTI_HOVER" to FlightMode.ATTI,
    "ATTI_LIMITED" to FlightMode.ATTI,
    "HOVER" to FlightMode.GPS_ATTI,
    "GPS_BRAKE" to FlightMode.GPS_ATTI,
    "GPS_ATTI" to FlightMode.GPS_ATTI,
    "ASSISTED_TAKE_OFF" to FlightMode.ASSISTED_TAKEOFF,
    "AUTO_TAKE_OFF" to FlightMode.AUTO_TAKEOFF,
    "TAKEOFF" to FlightMode.AUTO_TAKEOFF,
    "AUTO_LANDING" to FlightMode.AUTO_LANDING,
    "ATTI_LANDING" to FlightMode.AUTO_LANDING,
    "NAVI_GO" to FlightMode.WAYPOINT,
    "NAVI_GO_NEW" to FlightMode.WAYPOINT,
    "GO_HOME" to FlightMode.GO_HOME,
    "BACKUP_GO_HOME" to FlightMode.GO_HOME,
    "JOYSTICK" to FlightMode.JOYSTICK,
    "ACTIVE_TRACK" to FlightMode.ACTIVE_TRACK,
    "TAP_FLY" to FlightMode.TAP_FLY,
    "GPS_SPORT" to FlightMode.SPORT,
    "GPS_NOVICE" to FlightMode.NOVICE,
    "CONFIRM_LANDING" to FlightMode.CONFIRM_LANDING,
    "TRIPOD_GPS" to FlightMode.TRIPOD,
    "MOTOR_START" to FlightMode.MOTORS_JUST_STARTED,
)

private val MISSION_RUNS = setOf("ENTER_WAYLINE", "EXECUTING", "INTERRUPTED", "RECOVERING", "RETURN_TO_START_POINT")

/** Whether a mission is flown, by whomever it was started. */
internal val DjiSnapshot.isMissionFlown: Boolean get() = missionState in MISSION_RUNS

/** Whether a mission is being prepared or flown, which a new order must stop. */
internal val DjiSnapshot.isMissionActive: Boolean
    get() = isMissionFlown || missionState == "PREPARING" || missionState == "UPLOADING"

internal val DjiSnapshot.mode: FlightMode get() = FLIGHT_MODES[flightMode] ?: FlightMode.OTHER

/**
 * The state of the port from DJI's values; null until flight controller and position have reported.
 *
 * DJI's location altitude is already relative to the takeoff point; a position of exactly 0, 0 or NaN is
 * a receiver without a fix.
 */
internal fun aircraftState(
    snapshot: DjiSnapshot, isVideoOn: Boolean, facts: AircraftFacts = AircraftFacts(),
): AircraftState? {
    val isFlying = snapshot.isFlying ?: return null
    return AircraftState(
        updatedNs = snapshot.updatedNs,
        serial = snapshot.serial?.ifBlank { null },
        isFlying = isFlying,
        flightMode = snapshot.mode,
        position = position(snapshot),
        heightAboveTakeoffM = snapshot.altitudeM ?: Double.NaN,
        takeoffAltitudeM = snapshot.takeoffAltitudeM?.takeIf { it.isFinite() },
        velocity = VelocityNed(
            orNan(snapshot.velocityNorthMps), orNan(snapshot.velocityEastMps), orNan(snapshot.velocityDownMps),
        ),
        attitude = Attitude(orNan(snapshot.yawDeg), orNan(snapshot.pitchDeg), orNan(snapshot.rollDeg)),
        gnssSatelliteCount = snapshot.satellites ?: 0,
        gnssSignalLevel = levelOf(snapshot.gpsLevel),
        isAtMaxHeight = snapshot.isNearHeightLimit ?: false,
        isAtMaxDistance = snapshot.isNearDistanceLimit ?: false,
        batteryPercent = snapshot.batteryPercent,
        batteryWarning = batteryWarning(snapshot),
        windLevel = levelOf(snapshot.windWarning),
        cameraState = cameraState(snapshot, isVideoOn),
        needsLandingConfirmation = snapshot.isLandingConfirmationNeeded ?: false,
        capabilities = capabilities(snapshot),
        facts = facts,
    )
}

internal fun position(snapshot: DjiSnapshot): LatLon? {
    val latitude = snapshot.latitudeDeg?.takeIf { it.isFinite() } ?: return null
    val longitude = snapshot.longitudeDeg?.takeIf { it.isFinite() } ?: return null
    return LatLon(latitude, longitude).takeUnless { latitude == 0.0 && longitude == 0.0 }
}

private fun orNan(value: Double?): Double = value ?: Double.NaN

/** `LEVEL_5` is 5; none and unknown are null. */
private fun levelOf(name: String?): Int? = name?.removePrefix("LEVEL_")?.toIntOrNull()

private fun batteryWarning(snapshot: DjiSnapshot) = when {
    snapshot.isSeriousLowBattery == true -> BatteryWarning.SERIOUS
    snapshot.isLowBattery == true -> BatteryWarning.LOW
    else -> BatteryWarning.NONE
}

private fun cameraState(snapshot: DjiSnapshot, isVideoOn: Boolean) = when {
    snapshot.hasCamera != true -> CameraState.NOT_CONNECTED
    isVideoOn -> CameraState.FEED_ON
    else -> CameraState.FEED_OFF
}

private fun capabilities(snapshot: DjiSnapshot) = Capabilities(
    waypointMissions = when (snapshot.missionState) {
        null, "UNKNOWN", "DISCONNECTED" -> Capability.UNKNOWN
        "NOT_SUPPORTED" -> Capability.UNSUPPORTED
        else -> Capability.SUPPORTED
    },
    virtualStick = capability(snapshot.isVirtualStickSupported),
    camera = capability(snapshot.hasCamera),
    goHomeHeightM = snapshot.goHomeHeightM?.toDouble(),
    failsafe = when (snapshot.failsafe) {
        "HOVER" -> Failsafe.HOVER
        "LANDING" -> Failsafe.LAND
        "GOHOME" -> Failsafe.GO_HOME
        else -> Failsafe.UNKNOWN
    },
)

private fun capability(isSupported: Boolean?) = when (isSupported) {
    null -> Capability.UNKNOWN
    true -> Capability.SUPPORTED
    false -> Capability.UNSUPPORTED
}
