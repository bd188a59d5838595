package recon.msdk5

import recon.aircraft.AircraftFacts
import recon.aircraft.Attitude
import recon.aircraft.CameraMode
import recon.aircraft.RtkState
import recon.geo.LatLon

/** Values of DJI's keys that change seldom, as they were last reported; null for what was not. */
data class DjiReadings(
    val isHomeSet: Boolean? = null,
    val homeLatitudeDeg: Double? = null,
    val homeLongitudeDeg: Double? = null,
    val heightLimitM: Int? = null,
    val distanceLimitM: Int? = null,
    val isDistanceLimited: Boolean? = null,
    val firmware: String? = null,
    /** Of all batteries in order. */
    val cellsMv: List<Int> = emptyList(),
    val batteryTemperaturesC: List<Double> = emptyList(),
    val isRtkEnabled: Boolean? = null,
    val rtkSolution: String? = null,
    val storageLeftMb: Int? = null,
    val storageLeftPhotos: Int? = null,
    val gimbalYawDeg: Double? = null,
    val gimbalPitchDeg: Double? = null,
    val gimbalRollDeg: Double? = null,
    val cameraMode: String? = null,
    val photoIntervalS: Double? = null,
    val isExposureLocked: Boolean? = null,
    val exposureMode: String? = null,
    val whiteBalance: WhiteBalance? = null,
    /** Whether the camera tells its new files, and whether it takes a lock of its exposure. */
    val tellsFiles: Boolean? = null,
    val takesExposureLock: Boolean? = null,
)

/** DJI's mode of white balance by its name, with the colour temperature in DJI's unit. */
data class WhiteBalance(val mode: String, val temperature: Int?)

internal const val AUTO = "AUTO"
internal const val MANUAL = "MANUAL"
private const val UNKNOWN = "UNKNOWN"
private const val MV_PER_V = 1_000.0

private val SOLUTIONS = mapOf(
    "NONE" to RtkState.NONE,
    "SINGLE_POINT" to RtkState.SINGLE,
    "FLOAT" to RtkState.FLOAT,
    "FIXED_POINT" to RtkState.FIXED,
)

/** The facts in DJI's values of an aircraft. */
internal fun factsOf(snapshot: DjiSnapshot, readings: DjiReadings) = AircraftFacts(
    home = homeOf(readings),
    maxHeightM = readings.heightLimitM?.toDouble(),
    maxDistanceM = readings.distanceLimitM?.takeIf { readings.isDistanceLimited == true }?.toDouble(),
    model = snapshot.model?.name ?: snapshot.product?.takeUnless { it in UNTOLD },
    firmware = readings.firmware?.ifBlank { null },
    batteryCellsV = readings.cellsMv.map { it / MV_PER_V }.ifEmpty { null },
    batteryTemperatureC = readings.batteryTemperaturesC.maxOrNull(),
    rtk = if (readings.isRtkEnabled == false) RtkState.OFF else SOLUTIONS[readings.rtkSolution],
    storageLeftMb = readings.storageLeftMb,
    storageLeftPhotos = readings.storageLeftPhotos,
    gimbal = gimbalOf(readings),
    cameraMode = cameraModeOf(readings.cameraMode),
    photoIntervalS = readings.photoIntervalS?.takeIf { it > 0.0 },
    isExposureLocked = if (readings.exposureMode == MANUAL) true else readings.isExposureLocked,
    isWhiteBalanceLocked = readings.whiteBalance?.mode?.takeUnless { it == UNKNOWN }?.let { it != AUTO },
    reportsPhotos = readings.tellsFiles,
    locksCamera = readings.takesExposureLock == true,
    djiCheck = "registered with DJI",
    isDjiCheckPassed = true,
)

/** DJI's words for a product that it has not told yet. */
private val UNTOLD = setOf("UNRECOGNIZED", UNKNOWN)

private fun homeOf(readings: DjiReadings): LatLon? {
    if (readings.isHomeSet != true) return null
    val latitude = readings.homeLatitudeDeg?.takeIf { it.isFinite() } ?: return null
    val longitude = readings.homeLongitudeDeg?.takeIf { it.isFinite() } ?: return null
    return LatLon(latitude, longitude).takeUnless { latitude == 0.0 && longitude == 0.0 }
}

private fun gimbalOf(readings: DjiReadings): Attitude? {
    val pitch = readings.gimbalPitchDeg ?: return null
    return Attitude(readings.gimbalYawDeg ?: Double.NaN, pitch, readings.gimbalRollDeg ?: Double.NaN)
}

private fun cameraModeOf(name: String?): CameraMode? = when {
    name == null || name == UNKNOWN -> null
    name == "PHOTO_NORMAL" -> CameraMode.PHOTO
    name == "PHOTO_INTERVAL" -> CameraMode.INTERVAL
    name.startsWith("VIDEO") -> CameraMode.VIDEO
    else -> CameraMode.OTHER
}
