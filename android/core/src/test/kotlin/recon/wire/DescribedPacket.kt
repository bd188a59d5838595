package recon.wire

import com.google.gson.JsonArray
import com.google.gson.JsonElement
import com.google.gson.JsonObject
import com.google.gson.JsonPrimitive
import java.security.MessageDigest

/** The fields of a packet as `vectors/` describes them: floats as the hex of their bits, files as SHA-256. */
fun described(packet: Packet): JsonObject = when (packet) {
    is CoreTelemetry -> fields(
        "is_flying" to packet.isFlying,
        "latitude_deg" to packet.latitudeDeg,
        "longitude_deg" to packet.longitudeDeg,
        "altitude_m" to packet.altitudeM,
        "height_above_takeoff_m" to packet.heightAboveTakeoffM,
        "velocity_north_mps" to packet.velocityNorthMps,
        "velocity_east_mps" to packet.velocityEastMps,
        "velocity_down_mps" to packet.velocityDownMps,
        "yaw_deg" to packet.yawDeg,
        "pitch_deg" to packet.pitchDeg,
        "roll_deg" to packet.rollDeg,
    )
    is ExtendedTelemetry -> fields(
        "gnss_satellite_count" to packet.gnssSatelliteCount,
        "gnss_signal_level" to packet.gnssSignalLevel,
        "max_height_reached" to packet.maxHeightReached,
        "max_distance_reached" to packet.maxDistanceReached,
        "battery_percent" to packet.batteryPercent,
        "battery_warning" to packet.batteryWarning,
        "wind_level" to packet.windLevel,
        "camera_state" to packet.cameraState,
        "flight_mode" to packet.flightMode,
        "mission_id" to packet.missionId,
        "serial" to packet.serial,
    )
    is Image -> fields(
        "target_fps_hz" to packet.targetFpsHz,
        "rows" to packet.rows,
        "cols" to packet.cols,
        "pixels_sha256" to sha256(packet.pixels),
    )
    is CompressedImage -> fields("target_fps_hz" to packet.targetFpsHz, "jpeg_sha256" to sha256(packet.jpeg))
    is Acknowledgment -> fields("positive" to packet.positive, "source_pid" to packet.sourcePid)
    is MessageString -> fields("type" to packet.type, "text" to packet.text)
    is EmergencyCommand -> fields("action" to packet.action)
    is CameraControl -> fields("action" to packet.action, "target_fps_hz" to packet.targetFpsHz)
    is VirtualStickCommand -> fields(
        "mode" to packet.mode,
        "yaw_deg" to packet.yawDeg,
        "velocity_x_mps" to packet.velocityXMps,
        "velocity_y_mps" to packet.velocityYMps,
        "height_above_takeoff_m" to packet.heightAboveTakeoffM,
        "timeout_s" to packet.timeoutS,
    )
    is ExecuteWaypointMission -> fields(
        "land_at_end" to packet.landAtEnd,
        "curved_flight" to packet.curvedFlight,
        "waypoints" to JsonArray().apply { packet.waypoints.forEach { add(described(it)) } },
    )
    is UnknownPacket -> fields("payload" to packet.payload)
}

private fun described(waypoint: Waypoint): JsonObject = fields(
    "latitude_deg" to waypoint.latitudeDeg,
    "longitude_deg" to waypoint.longitudeDeg,
    "altitude_m" to waypoint.altitudeM,
    "corner_radius_m" to waypoint.cornerRadiusM,
    "speed_mps" to waypoint.speedMps,
    "loiter_time_s" to waypoint.loiterTimeS,
    "gimbal_pitch_deg" to waypoint.gimbalPitchDeg,
)

private fun fields(vararg values: Pair<String, Any>) =
    JsonObject().apply { values.forEach { (name, value) -> add(name, shown(value)) } }

private fun shown(value: Any): JsonElement = when (value) {
    is JsonElement -> value
    is Float -> JsonPrimitive("%08x".format(value.toRawBits()))
    is Double -> JsonPrimitive("%016x".format(value.toRawBits()))
    is Bytes -> JsonPrimitive(hex(value.toByteArray()))
    is Int -> JsonPrimitive(value)
    else -> JsonPrimitive(value.toString())
}

private fun sha256(bytes: Bytes) = hex(MessageDigest.getInstance("SHA-256").digest(bytes.toByteArray()))
