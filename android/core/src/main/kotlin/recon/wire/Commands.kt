package recon.wire

/** PID 255; [action] 0 hover, 1 land now, 2 return home and land. */
data class EmergencyCommand(val action: Int) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) = out.u8("action", action)

    companion object {
        const val PID = 255
        const val HOVER = 0
        const val LAND = 1
        const val RETURN_HOME = 2
        internal val FORMAT = fixedFormat(PID, 1) { EmergencyCommand(it.u8()) }
    }
}

/** PID 254; [action] 0 stop sending images, 1 start at [targetFpsHz]; by the extension 2 lock the camera, 3 unlock. */
data class CameraControl(val action: Int, val targetFpsHz: Float) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.u8("action", action)
        out.f32(targetFpsHz)
    }

    companion object {
        const val PID = 254
        const val STOP = 0
        const val START = 1
        const val LOCK = 2
        const val UNLOCK = 3
        internal val FORMAT = fixedFormat(PID, 5) { CameraControl(it.u8(), it.f32()) }
    }
}

/** PID 253: replaces the mission being flown. */
data class ExecuteWaypointMission(val landAtEnd: Int, val curvedFlight: Int, val waypoints: List<Waypoint>) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.u8("land_at_end", landAtEnd)
        out.u8("curved_flight", curvedFlight)
        waypoints.forEach { it.write(out) }
    }

    companion object {
        const val PID = 253
        private const val EMPTY_BYTES = 11L

        internal val FORMAT = PacketFormat(
            PID,
            widest = {
                val waypoint = Waypoint.BYTES.toLong()
                SizeRule.Between(EMPTY_BYTES + waypoint, EMPTY_BYTES + waypoint * it.maxWaypoints, step = waypoint)
            },
            read = {
                ExecuteWaypointMission(it.u8(), it.u8(), List(it.remaining / Waypoint.BYTES) { _ -> Waypoint.read(it) })
            },
        )
    }
}

/**
 * One waypoint of PID 253. [altitudeM] is a WGS84 altitude by the document and a height above takeoff
 * by its later revision; nothing on the wire tells which (`recon.aircraft.AltitudeReference`).
 * NaN in [loiterTimeS] and [gimbalPitchDeg] means no action.
 */
data class Waypoint(
    val latitudeDeg: Double,
    val longitudeDeg: Double,
    val altitudeM: Double,
    val cornerRadiusM: Float,
    val speedMps: Float,
    val loiterTimeS: Float,
    val gimbalPitchDeg: Float,
) {
    internal fun write(out: FieldWriter) {
        for (value in doubleArrayOf(latitudeDeg, longitudeDeg, altitudeM)) out.f64(value)
        for (value in floatArrayOf(cornerRadiusM, speedMps, loiterTimeS, gimbalPitchDeg)) out.f32(value)
    }

    internal companion object {
        const val BYTES = 40

        fun read(reader: FieldReader) = Waypoint(
            reader.f64(), reader.f64(), reader.f64(),
            reader.f32(), reader.f32(), reader.f32(), reader.f32(),
        )
    }
}

/** PID 252; [mode] 0 velocities north and east, 1 forward and right; heights above takeoff. */
data class VirtualStickCommand(
    val mode: Int,
    val yawDeg: Float,
    val velocityXMps: Float,
    val velocityYMps: Float,
    val heightAboveTakeoffM: Float,
    val timeoutS: Float,
) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.u8("mode", mode)
        for (value in floatArrayOf(yawDeg, velocityXMps, velocityYMps, heightAboveTakeoffM, timeoutS)) out.f32(value)
    }

    companion object {
        const val PID = 252
        internal val FORMAT = fixedFormat(PID, 21) {
            VirtualStickCommand(it.u8(), it.f32(), it.f32(), it.f32(), it.f32(), it.f32())
        }
    }
}
