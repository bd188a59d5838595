package recon.session

import recon.aircraft.AircraftState
import recon.aircraft.altitudeM
import recon.wire.Bytes
import recon.wire.CoreTelemetry
import recon.wire.ExtendedTelemetry

private const val UNKNOWN_BATTERY = 255
private const val OTHER_MODE = 255
private const val NO_LEVEL = -1

/** PID 0 of a state (ICD 3.1.1). A missing position is sent as 0, 0: unknown. */
fun coreTelemetryOf(state: AircraftState) = CoreTelemetry(
    isFlying = flag(state.isFlying),
    latitudeDeg = state.position?.latitudeDeg ?: 0.0,
    longitudeDeg = state.position?.longitudeDeg ?: 0.0,
    altitudeM = state.altitudeM(),
    heightAboveTakeoffM = state.heightAboveTakeoffM,
    velocityNorthMps = state.velocity.northMps.toFloat(),
    velocityEastMps = state.velocity.eastMps.toFloat(),
    velocityDownMps = state.velocity.downMps.toFloat(),
    yawDeg = state.attitude.yawDeg,
    pitchDeg = state.attitude.pitchDeg,
    rollDeg = state.attitude.rollDeg,
)

/** PID 1 of a state (ICD 3.1.2); without one an empty serial and unknown values: an unidentified link. */
fun extendedTelemetryOf(state: AircraftState?, missionId: Int): ExtendedTelemetry =
    if (state == null) UNIDENTIFIED else ExtendedTelemetry(
        gnssSatelliteCount = state.gnssSatelliteCount.coerceIn(0, 0xFFFF),
        gnssSignalLevel = (state.gnssSignalLevel ?: NO_LEVEL).coerceIn(NO_LEVEL, 10),
        maxHeightReached = flag(state.isAtMaxHeight),
        maxDistanceReached = flag(state.isAtMaxDistance),
        batteryPercent = state.batteryPercent?.coerceIn(0, 100) ?: UNKNOWN_BATTERY,
        batteryWarning = state.batteryWarning.wireValue,
        windLevel = (state.windLevel ?: NO_LEVEL).coerceIn(NO_LEVEL, 127),
        cameraState = state.cameraState.wireValue,
        flightMode = state.flightMode.wireValue,
        missionId = missionId,
        serial = serialOf(state),
    )

private val UNIDENTIFIED =
    ExtendedTelemetry(0, NO_LEVEL, 0, 0, UNKNOWN_BATTERY, 0, NO_LEVEL, 0, OTHER_MODE, 0, Bytes.EMPTY)

private const val MOST_SERIAL_BYTES = 256

private fun serialOf(state: AircraftState): Bytes {
    val bytes = Bytes.of(state.serial.orEmpty())
    return if (bytes.size <= MOST_SERIAL_BYTES) bytes else Bytes.copyOf(bytes.toByteArray(), 0, MOST_SERIAL_BYTES)
}

private fun flag(value: Boolean): Int = if (value) 1 else 0
