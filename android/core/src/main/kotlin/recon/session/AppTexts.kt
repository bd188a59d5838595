package recon.session

import recon.aircraft.AircraftState
import recon.aircraft.Capability
import recon.aircraft.Failsafe
import recon.aircraft.ReleasedPhoto
import recon.mission.MissionLimits

/** Of one text of the extension, which the station refuses beyond. */
internal const val LONGEST_APP_TEXT_BYTES = 4096
internal const val MOST_PHOTOS_OF_TEXT = 16

internal const val LONGEST_NAME = 64
internal const val LONGEST_SENTENCE = 200
private const val MOST_CELLS = 48
private const val LARGEST_U32 = 0xFFFF_FFFFL
private const val LARGEST_TIME_MS = 1L shl 53

/** The photos of one aircraft: the number of their count, and how many there are. */
internal data class PhotoSeries(val number: Long, val count: Long, val serial: String?)

/** A photo with its index in its series. */
internal data class NumberedPhoto(val series: Long, val index: Long, val photo: ReleasedPhoto)

/** The text of all that is known of an aircraft (docs/icd.md, "Facts"). */
internal fun factsText(state: AircraftState, appName: String, series: PhotoSeries): String {
    val facts = state.facts
    val can = state.capabilities
    return text("facts") {
        number("go_home_height_m", can.goHomeHeightM, 0.0, 2_000.0, digits = 1)
        word("failsafe", FAILSAFE[can.failsafe])
        number("home_latitude_deg", facts.home?.latitudeDeg, -90.0, 90.0, digits = 7)
        number("home_longitude_deg", facts.home?.longitudeDeg, -180.0, 180.0, digits = 7)
        number("max_height_m", facts.maxHeightM, 0.0, 10_000.0, digits = 1)
        number("max_distance_m", facts.maxDistanceM, 0.0, 100_000.0, digits = 1)
        text("model", facts.model, LONGEST_NAME)
        text("firmware", facts.firmware, LONGEST_NAME)
        text("app", appName, LONGEST_NAME)
        batteries(facts.batteryCellsV, facts.batteryTemperatureC)
        word("rtk", facts.rtk?.word)
        whole("storage_left_mb", facts.storageLeftMb?.toLong(), 0, 100_000_000)
        whole("storage_left_photos", facts.storageLeftPhotos?.toLong(), 0, 10_000_000)
        number("gimbal_yaw_deg", facts.gimbal?.yawDeg, -360.0, 360.0, digits = 1)
        number("gimbal_pitch_deg", facts.gimbal?.pitchDeg, -360.0, 360.0, digits = 1)
        number("gimbal_roll_deg", facts.gimbal?.rollDeg, -360.0, 360.0, digits = 1)
        word("camera_mode", facts.cameraMode?.word)
        number("photo_interval_s", facts.photoIntervalS, 0.1, 3_600.0, digits = 2)
        flag("exposure_locked", facts.isExposureLocked)
        flag("white_balance_locked", facts.isWhiteBalanceLocked)
        flag("can_fly_missions", flagOf(can.waypointMissions))
        whole("max_waypoints", MissionLimits.MOST_WAYPOINTS.toLong(), 0, 65_535)
        flag("dji_check_passed", facts.isDjiCheckPassed)
        text("dji_check", facts.djiCheck, LONGEST_SENTENCE)
        flag("reports_photos", facts.reportsPhotos)
        whole("photo_series", series.number, 0, LARGEST_U32)
        whole("photo_count", series.count, 0, LARGEST_U32)
        list("orders", listOf("\"lock_camera\"").takeIf { facts.locksCamera })
    }
}

/** The text of photos of one series; [serial] of the aircraft that took them, when it is not that of the link. */
internal fun photosText(photos: List<NumberedPhoto>, serial: String?, nowNs: Long): String = text("photos") {
    whole("series", photos.first().series, 0, LARGEST_U32)
    text("serial", serial, longest = 256)
    list("photos", photos.map { photoJson(it, nowNs) })
}

private val FAILSAFE = mapOf(Failsafe.GO_HOME to "go_home", Failsafe.HOVER to "hover", Failsafe.LAND to "land")

private fun flagOf(capability: Capability): Boolean? = when (capability) {
    Capability.SUPPORTED -> true
    Capability.UNSUPPORTED -> false
    Capability.UNKNOWN -> null
}

private fun JsonText.batteries(cellsV: List<Double>?, temperatureC: Double?) {
    val isSound = cellsV != null && cellsV.size in 1..MOST_CELLS && cellsV.all { it in 0.0..10.0 }
    list("battery_cells_v", cellsV?.takeIf { isSound }?.map { JsonText.plain(it, digits = 3) })
    number("battery_temperature_c", temperatureC, -60.0, 150.0, digits = 1)
}

private fun photoJson(numbered: NumberedPhoto, nowNs: Long): String = with(numbered.photo) {
    JsonText().apply {
        whole("index", numbered.index, 1, LARGEST_U32)
        number("age_s", ageS(takenNs, nowNs), 0.0, 3_600.0, digits = 3)
        whole("time_utc_ms", timeUtcMs, 0, LARGEST_TIME_MS)
        number("latitude_deg", position?.latitudeDeg, -90.0, 90.0, digits = 7)
        number("longitude_deg", position?.longitudeDeg, -180.0, 180.0, digits = 7)
        number("height_above_takeoff_m", heightAboveTakeoffM, -500.0, 10_000.0, digits = 2)
        number("yaw_deg", yawDeg, -360.0, 360.0, digits = 1)
        number("gimbal_pitch_deg", gimbalPitchDeg, -360.0, 360.0, digits = 1)
        text("lens", lens, LONGEST_NAME)
    }.toString()
}

/** Age of what happened at a time, seconds; clocks of other threads may be a little ahead. */
internal fun ageS(takenNs: Long, nowNs: Long): Double = maxOf(0.0, (nowNs - takenNs) / 1e9)

internal fun text(kind: String, content: JsonText.() -> Unit): String =
    "recon 1 " + JsonText().apply { word("kind", kind) }.apply(content)
