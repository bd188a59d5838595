package recon.aircraft

import recon.geo.LatLon

/** State of the RTK receiver; [NONE]: on, without a solution. */
enum class RtkState(val word: String) {
    OFF("off"), NONE("none"), SINGLE("single"), FLOAT("float"), FIXED("fixed"),
}

enum class CameraMode(val word: String) { PHOTO("photo"), INTERVAL("interval"), VIDEO("video"), OTHER("other") }

/**
 * Settings and state of the aircraft that telemetry has no field for, as they are read from it. Null: not
 * reported. Heights are above takeoff.
 */
data class AircraftFacts(
    val home: LatLon? = null,
    val maxHeightM: Double? = null,
    /** From home; null when the aircraft has none set, too. */
    val maxDistanceM: Double? = null,
    val model: String? = null,
    val firmware: String? = null,
    /** Of all batteries in order, V. */
    val batteryCellsV: List<Double>? = null,
    /** Of the warmest battery. */
    val batteryTemperatureC: Double? = null,
    val rtk: RtkState? = null,
    val storageLeftMb: Int? = null,
    val storageLeftPhotos: Int? = null,
    /** Yaw 0 north, clockwise; pitch -90 straight down. */
    val gimbal: Attitude? = null,
    val cameraMode: CameraMode? = null,
    /** Interval of the camera's timer as it is set, running or not. */
    val photoIntervalS: Double? = null,
    val isExposureLocked: Boolean? = null,
    val isWhiteBalanceLocked: Boolean? = null,
    /** Whether each photo is passed to the listener of [Aircraft.onPhoto]. */
    val reportsPhotos: Boolean? = null,
    /** Whether it takes [AircraftCommand.LockCamera]. */
    val locksCamera: Boolean = false,
    /** The answer of the SDK's own check of this app, as a sentence, and whether it passed. */
    val djiCheck: String? = null,
    val isDjiCheckPassed: Boolean? = null,
)

/** One release of the shutter that the camera has confirmed, whatever number of lenses and files it has. */
data class ReleasedPhoto(
    /** At the shutter, nanoseconds of the session's clock. */
    val takenNs: Long,
    /** By the phone's clock, milliseconds since 1970. */
    val timeUtcMs: Long,
    val serial: String? = null,
    val position: LatLon? = null,
    val heightAboveTakeoffM: Double? = null,
    val yawDeg: Double? = null,
    val gimbalPitchDeg: Double? = null,
    /** `wide`, `visible` or `multispectral`. */
    val lens: String? = null,
)
