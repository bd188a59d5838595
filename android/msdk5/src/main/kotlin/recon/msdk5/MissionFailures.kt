package recon.msdk5

import recon.aircraft.MissionAction

private const val AGAIN = "send the mission again, with the controller near the aircraft"
private const val TAKE_OUT =
    "send it once more; if it comes again, this firmware does not take such files: fly by sticks, or export the " +
        "plan for DJI's own app"
private const val FIX = "wait for a better GNSS fix under open sky"
private const val NORMAL_MODE = "set the controller's mode switch to N"
private const val HOVER_FIRST = "send a hover, then the mission again"

/**
 * What to try, by DJI's error code (`DJIWaypointMissionError`, and the common ones). What is not listed is
 * answered with DJI's own words alone.
 */
private val TRY = mapOf(
    "WPMZ_FILE_LOAD_ERROR" to TAKE_OUT,
    "WAYLINE_INFO_ERROR" to TAKE_OUT,
    "REQUEST_HANDLER_NOT_FOUND" to "this firmware has no waypoint missions: fly by sticks, or by hand",
    "WAYPOINT_METHOD_NOT_SUPPORT" to "this firmware has no waypoint missions: fly by sticks, or by hand",
    "UNSUPPORTED" to "this firmware has no waypoint missions: fly by sticks, or by hand",
    "UPLOAD_FILE_FAILED" to AGAIN,
    "FILE_TRANSFER_FAIL" to AGAIN,
    "SDR_CHANGE_FAIL" to AGAIN,
    "PRECISE_FILE_MD5_CHECK_FAIL" to AGAIN,
    "SEND_PACK_TIMEOUT" to AGAIN,
    "SEND_PACK_FAILED" to AGAIN,
    "PARSE_RETURN_PACK_FAILED" to AGAIN,
    "TIMEOUT" to AGAIN,
    "SYSTEM_BUSY" to AGAIN,
    "DISCONNECTED" to "connect the aircraft with its controller",
    "MISSION_ID_NOT_EXIST" to AGAIN,
    "FILE_NOT_EXIST" to AGAIN,
    "START_MISSION_INVALID_FILE_NAME" to AGAIN,
    "GPS_INVALID" to FIX,
    "CANNOT_START_TASK_ON_WEAK_GPS" to FIX,
    "HOME_POINT_NOT_RECORDED" to "wait until the controller says that the home point is set",
    "RTK_NOT_READY" to "wait for the RTK fix, or switch RTK off in DJI's app",
    "HEIGHT_LIMIT" to "raise the maximum height in DJI's app, or plan lower",
    "LOW_LIMIT" to "plan higher: a part of the mission is too low",
    "RADIUS_LIMIT" to "raise the maximum distance in DJI's app, or take off nearer",
    "LOWER_BATTERY" to "change the battery",
    "CANNOT_START_AT_CURRENT_RC_MODE" to NORMAL_MODE,
    "NOT_IN_NORMAL_MODE" to NORMAL_MODE,
    "CANNOT_START_WAYLINE_WHEN_WAYLINE_RUNNING" to HOVER_FIRST,
    "CANNOT_BREAK_WAYLINE_IN_CUR_STATE" to HOVER_FIRST,
    "CANT_EXCUTE_IN_CURRENT_STATUS" to HOVER_FIRST,
    "RETURN_HOME" to HOVER_FIRST,
    "DRONE_ON_GROUND_MOTOR_ON" to "stop the motors, or take off by the controller first",
    "TRAJ_ON_GROUND_MOTOR_ON_CANNOT_GO" to "stop the motors, or take off by the controller first",
    "MOTOR_STATE_ERROR" to "look at the controller: the motors do not start",
    "OBSTACAL_STOP" to "look for an obstacle in front of the aircraft",
    "DRONE_CRITICAL_ERROR" to "land, and read the aircraft's warnings in DJI's app",
)

/** Codes that tell that the aircraft has the file and does not take what is in it. */
private val LOADING = setOf("WPMZ_FILE_LOAD_ERROR", "WAYLINE_INFO_ERROR")
private const val OF_ROUTE = "TRAJ_"

/** Whether DJI refuses the content of a mission's file, and not the moment. */
internal fun isOfContent(error: DjiError): Boolean = error.code in LOADING || error.code.startsWith(OF_ROUTE)

/** A failed step as a sentence: which one, DJI's words and code, and what to try where that is known. */
internal fun missionFailure(step: MissionAction, error: DjiError): String {
    val what = when (step) {
        MissionAction.UPLOAD -> "Upload failed"
        MissionAction.LOAD -> "Uploaded, but the aircraft cannot load the file"
        MissionAction.START -> "Uploaded, but not started"
    }
    val advice = TRY[error.code] ?: TAKE_OUT.takeIf { error.code.startsWith(OF_ROUTE) }
    return "$what: $error" + (advice?.let { ". To try: $it" } ?: "")
}
