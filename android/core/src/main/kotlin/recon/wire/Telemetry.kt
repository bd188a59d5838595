package recon.wire

/** PID 0, about ten times a second. Degrees, metres, metres per second; [velocityDownMps] positive down. */
data class CoreTelemetry(
    val isFlying: Int,
    val latitudeDeg: Double,
    val longitudeDeg: Double,
    val altitudeM: Double,
    val heightAboveTakeoffM: Double,
    val velocityNorthMps: Float,
    val velocityEastMps: Float,
    val velocityDownMps: Float,
    val yawDeg: Double,
    val pitchDeg: Double,
    val rollDeg: Double,
) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.u8("is_flying", isFlying)
        for (value in doubleArrayOf(latitudeDeg, longitudeDeg, altitudeM, heightAboveTakeoffM)) out.f64(value)
        for (value in floatArrayOf(velocityNorthMps, velocityEastMps, velocityDownMps)) out.f32(value)
        for (value in doubleArrayOf(yawDeg, pitchDeg, rollDeg)) out.f64(value)
    }

    companion object {
        const val PID = 0
        internal val FORMAT = fixedFormat(PID, 69) {
            CoreTelemetry(
                it.u8(),
                it.f64(), it.f64(), it.f64(), it.f64(),
                it.f32(), it.f32(), it.f32(),
                it.f64(), it.f64(), it.f64(),
            )
        }
    }
}

/** PID 1, about twice a second; [serial] is the aircraft's identity, `00000` or nothing means none. */
data class ExtendedTelemetry(
    val gnssSatelliteCount: Int,
    val gnssSignalLevel: Int,
    val maxHeightReached: Int,
    val maxDistanceReached: Int,
    val batteryPercent: Int,
    val batteryWarning: Int,
    val windLevel: Int,
    val cameraState: Int,
    val flightMode: Int,
    val missionId: Int,
    val serial: Bytes,
) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.u16("gnss_satellite_count", gnssSatelliteCount)
        out.i8("gnss_signal_level", gnssSignalLevel)
        out.u8("max_height_reached", maxHeightReached)
        out.u8("max_distance_reached", maxDistanceReached)
        out.u8("battery_percent", batteryPercent)
        out.u8("battery_warning", batteryWarning)
        out.i8("wind_level", windLevel)
        out.u8("camera_state", cameraState)
        out.u8("flight_mode", flightMode)
        out.u16("mission_id", missionId)
        out.string(serial)
    }

    companion object {
        const val PID = 1
        private const val EMPTY_BYTES = 25L
        private const val LENGTH_AT = 12

        internal val FORMAT = PacketFormat(
            PID,
            lengthBytes = LENGTH_AT + 4,
            widest = { SizeRule.Between(EMPTY_BYTES, EMPTY_BYTES + it.maxSerialBytes) },
            rule = { reader, limits ->
                reader.skip(LENGTH_AT)
                textRule("a serial", EMPTY_BYTES, reader.u32(), limits.maxSerialBytes)
            },
            read = {
                ExtendedTelemetry(
                    it.u16(), it.i8(), it.u8(), it.u8(), it.u8(), it.u8(), it.i8(), it.u8(), it.u8(), it.u16(),
                    it.string(),
                )
            },
        )
    }
}

internal fun textRule(what: String, emptyBytes: Long, claimed: Long, most: Int): SizeRule =
    if (claimed <= most) SizeRule.Exactly(emptyBytes + claimed) else SizeRule.Over(what, "$most bytes", "$claimed")
