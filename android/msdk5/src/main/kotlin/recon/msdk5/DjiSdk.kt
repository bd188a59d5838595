package recon.msdk5

/** DJI's error: its code by name, and its description. */
data class DjiError(val code: String, val description: String) {
    override fun toString() = "$description ($code)"
}

/** Called once with null for success, else with DJI's error. */
typealias Done = (DjiError?) -> Unit

/** Actions of the flight controller, named as DJI's keys. */
enum class FlightAction {
    START_TAKEOFF,
    STOP_TAKEOFF,
    START_AUTO_LANDING,
    STOP_AUTO_LANDING,
    CONFIRM_LANDING,
    START_GO_HOME,
    STOP_GO_HOME,
}

/** Parameters of an advanced virtual stick in velocity mode, with heading as an angle. */
data class DjiStick(
    val isBodyFrame: Boolean,
    /** In velocity mode DJI's roll is X: north or forward. */
    val rollMps: Double,
    /** In velocity mode DJI's pitch is Y: east or right. */
    val pitchMps: Double,
    val yawDeg: Double,
    /** Positive up. */
    val verticalMps: Double,
)

/** Values of DJI's keys as they were last reported; null for what was not. Enumerations by their names. */
data class DjiSnapshot(
    /** When the flight controller last reported its attitude, nanoseconds. */
    val updatedNs: Long,
    val serial: String? = null,
    val isFlying: Boolean? = null,
    val flightMode: String? = null,
    val latitudeDeg: Double? = null,
    val longitudeDeg: Double? = null,
    /** Above the takeoff point, although its key is one of a location. */
    val altitudeM: Double? = null,
    val takeoffAltitudeM: Double? = null,
    val velocityNorthMps: Double? = null,
    val velocityEastMps: Double? = null,
    val velocityDownMps: Double? = null,
    val yawDeg: Double? = null,
    val pitchDeg: Double? = null,
    val rollDeg: Double? = null,
    val satellites: Int? = null,
    val gpsLevel: String? = null,
    val isNearHeightLimit: Boolean? = null,
    val isNearDistanceLimit: Boolean? = null,
    val batteryPercent: Int? = null,
    val isLowBattery: Boolean? = null,
    val isSeriousLowBattery: Boolean? = null,
    val windWarning: String? = null,
    val isLandingConfirmationNeeded: Boolean? = null,
    val goHomeHeightM: Int? = null,
    val failsafe: String? = null,
    val isVirtualStickSupported: Boolean? = null,
    val isVirtualStickEnabled: Boolean? = null,
    val missionState: String? = null,
    /** Name of the mission that is flown, whoever has started it. */
    val missionName: String? = null,
    /** Whether the SDK lists a camera; null before it has listed any. */
    val hasCamera: Boolean? = null,
    /** DJI's `ProductType` and `CameraType` by their names: `UNRECOGNIZED` for some seconds after the start. */
    val product: String? = null,
    val camera: String? = null,
    /** -90 straight down. */
    val gimbalPitchDeg: Double? = null,
)

/**
 * What the adapter uses of DJI's Mobile SDK 5, in plain types. `Msdk5` calls DJI and decides nothing;
 * tests record the calls.
 */
interface DjiSdk {
    fun snapshot(): DjiSnapshot?

    fun perform(action: FlightAction, done: Done)

    /** Takes the sticks from the controller, in advanced mode. */
    fun enableVirtualStick(done: Done)

    fun disableVirtualStick(done: Done)

    fun sendStick(stick: DjiStick)

    /** What DJI's own checker says of a mission file; does not reach the aircraft. */
    fun checkMission(name: String, kmz: ByteArray): FileCheck

    /** Uploads a mission file under a name. */
    fun pushMission(name: String, kmz: ByteArray, done: Done)

    fun startMission(name: String, done: Done)

    fun stopMission(name: String, done: Done)

    /** Holds whatever mission is flown; it can be resumed by the controller only. */
    fun pauseMission(done: Done)

    /** What changes seldom; read at most once a second. */
    fun readings(): DjiReadings

    fun lockExposure(isLocked: Boolean, done: Done)

    fun setWhiteBalance(wanted: WhiteBalance, done: Done)

    /** Passes what the camera tells of its photos, until null. */
    fun onCamera(listener: ((CameraEvent) -> Unit)?)

    /** Passes frames in NV21 to the listener (bytes, width, height), until null. */
    fun onFrame(listener: ((ByteArray, Int, Int) -> Unit)?)
}
