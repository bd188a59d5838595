package recon.sim

import kotlin.math.abs
import kotlin.math.cos
import kotlin.math.hypot
import kotlin.math.sin
import kotlin.math.sqrt

/** Position, velocity and heading in metres and degrees from the aircraft's home; height above takeoff. */
data class Motion(
    val northM: Double = 0.0,
    val eastM: Double = 0.0,
    val heightM: Double = 0.0,
    val northMps: Double = 0.0,
    val eastMps: Double = 0.0,
    val upMps: Double = 0.0,
    val yawDeg: Double = 0.0,
) {
    val groundSpeedMps: Double get() = hypot(northMps, eastMps)
}

/** Requested velocity; [yawDeg] null keeps the heading. */
data class VelocityDemand(
    val northMps: Double = 0.0,
    val eastMps: Double = 0.0,
    val upMps: Double = 0.0,
    val yawDeg: Double? = null,
)

/** Limits of a small multirotor and its flight controller. */
data class AirframeLimits(
    val speedMps: Double = 15.0,
    val accelerationMps2: Double = 3.0,
    val climbMps: Double = 4.0,
    val descentMps: Double = 3.0,
    val verticalAccelerationMps2: Double = 2.5,
    val yawRateDps: Double = 90.0,
)

/** The motion [seconds] later: velocities follow the demand within the limits. */
fun Motion.after(demand: VelocityDemand, seconds: Double, limits: AirframeLimits): Motion {
    val (wantedNorth, wantedEast) = clipped(demand.northMps, demand.eastMps, limits.speedMps)
    val (changeNorth, changeEast) =
        clipped(wantedNorth - northMps, wantedEast - eastMps, limits.accelerationMps2 * seconds)
    val largest = limits.verticalAccelerationMps2 * seconds
    val up = upMps + (demand.upMps.coerceIn(-limits.descentMps, limits.climbMps) - upMps).coerceIn(-largest, largest)
    val turn = limits.yawRateDps * seconds
    val yaw = demand.yawDeg?.let { wrappedDeg(yawDeg + wrappedDeg(it - yawDeg).coerceIn(-turn, turn)) } ?: yawDeg
    val north = northMps + changeNorth
    val east = eastMps + changeEast
    return Motion(
        northM + 0.5 * (northMps + north) * seconds,
        eastM + 0.5 * (eastMps + east) * seconds,
        heightM + 0.5 * (upMps + up) * seconds,
        north,
        east,
        up,
        yaw,
    )
}

/** The speed from which a stop within a distance is possible; near the target linear, so that it settles. */
fun brakingSpeedMps(distanceM: Double, decelerationMps2: Double): Double =
    if (distanceM < decelerationMps2) distanceM
    else sqrt(2.0 * decelerationMps2 * (distanceM - 0.5 * decelerationMps2))

/** The vertical velocity that brings the aircraft to a height and holds it there. */
fun Motion.towardsHeightMps(targetM: Double, limits: AirframeLimits): Double {
    val errorM = targetM - heightM
    val speed = brakingSpeedMps(abs(errorM), 0.4 * limits.verticalAccelerationMps2)
    return if (errorM > 0.0) minOf(speed, limits.climbMps) else -minOf(speed, limits.descentMps)
}

/** Velocity of a body frame (forward, right) in north and east. */
fun fromBody(forward: Double, right: Double, yawDeg: Double): Pair<Double, Double> {
    val yaw = Math.toRadians(yawDeg)
    return Pair(forward * cos(yaw) - right * sin(yaw), forward * sin(yaw) + right * cos(yaw))
}

/** An angle within -180 to 180 degrees. */
fun wrappedDeg(angleDeg: Double): Double = angleDeg - 360.0 * Math.floor((angleDeg + 180.0) / 360.0)

private fun clipped(x: Double, y: Double, longest: Double): Pair<Double, Double> {
    val length = hypot(x, y)
    return if (length <= longest) Pair(x, y) else Pair(x * longest / length, y * longest / length)
}
