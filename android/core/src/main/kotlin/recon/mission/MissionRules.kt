package recon.mission

import recon.aircraft.AltitudeReference
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import recon.geo.LatLon
import recon.geo.distanceM
import recon.wire.ExecuteWaypointMission
import recon.wire.Waypoint
import kotlin.math.abs

/** A plan, or the sentence why the packet cannot be flown. */
sealed interface PlanResult {
    data class Ready(val plan: MissionPlan) : PlanResult

    data class Refused(val reason: String) : PlanResult
}

/**
 * What DJI's waypoint missions accept (WPML reference, and the limits of Mobile SDK 4 where narrower).
 * The aircraft drops what does not fit without a word, so the app refuses it first, with a reason.
 */
object MissionLimits {
    const val LEAST_WAYPOINTS = 2
    const val MOST_WAYPOINTS = 99
    const val LOWEST_M = -200.0
    const val HIGHEST_M = 500.0
    const val SLOWEST_MPS = 1.0
    const val FASTEST_MPS = 15.0
    const val LONGEST_LOITER_S = 32.767
    const val CLOSEST_M = 0.5
    const val FARTHEST_M = 2_000.0
    const val LONGEST_PATH_M = 30_000.0

    /** Single precision on the wire: 15 m/s or 0.2 m may come a little beside. */
    const val TOLERANCE = 1e-3
}

/** Converts a mission packet to a plan in heights above takeoff, or states why it cannot be flown. */
fun planOf(packet: ExecuteWaypointMission, reference: AltitudeReference, takeoffAltitudeM: Double?): PlanResult {
    val points = packet.waypoints.mapIndexed { index, waypoint ->
        val height = reference.heightAboveTakeoffM(waypoint.altitudeM, takeoffAltitudeM)
            ?: return PlanResult.Refused("Waypoint altitudes are WGS84 here, and the takeoff altitude is unknown")
        pointProblem(waypoint, height)?.let { return PlanResult.Refused("Waypoint ${index + 1}: $it") }
        pointOf(waypoint, height)
    }
    val plan = MissionPlan(points, packet.curvedFlight == 1, packet.landAtEnd == 1)
    val problem = flagProblem(packet) ?: planProblem(plan)
    return if (problem == null) PlanResult.Ready(plan) else PlanResult.Refused(problem)
}

private fun pointOf(waypoint: Waypoint, heightM: Double) = PlanPoint(
    LatLon(waypoint.latitudeDeg, waypoint.longitudeDeg),
    heightM,
    waypoint.speedMps.toDouble(),
    waypoint.cornerRadiusM.toDouble(),
    // WPML has no stay of 0 s, and NaN means no action.
    waypoint.loiterTimeS.toDouble().takeIf { it > 0.0 },
    waypoint.gimbalPitchDeg.toDouble().takeUnless { it.isNaN() },
)

private fun flagProblem(packet: ExecuteWaypointMission): String? = when {
    packet.landAtEnd > 1 -> "LandAtEnd must be 0 or 1; got ${packet.landAtEnd}"
    packet.curvedFlight > 1 -> "CurvedFlight must be 0 or 1; got ${packet.curvedFlight}"
    else -> null
}

private fun pointProblem(waypoint: Waypoint, heightM: Double): String? {
    val loiter = waypoint.loiterTimeS.toDouble()
    val pitch = waypoint.gimbalPitchDeg.toDouble()
    return rangeProblem("latitude", waypoint.latitudeDeg, -90.0, 90.0, "degrees")
        ?: rangeProblem("longitude", waypoint.longitudeDeg, -180.0, 180.0, "degrees")
        ?: rangeProblem("height above takeoff", heightM, MissionLimits.LOWEST_M, MissionLimits.HIGHEST_M, "m")
        ?: rangeProblem(
            "speed", waypoint.speedMps.toDouble(), MissionLimits.SLOWEST_MPS, MissionLimits.FASTEST_MPS, "m/s",
        )
        ?: actionProblem("loiter", loiter, 0.0, MissionLimits.LONGEST_LOITER_S, "s")
        ?: actionProblem("gimbal pitch", pitch, -90.0, 0.0, "degrees")
}

/** NaN means no action. */
private fun actionProblem(what: String, value: Double, low: Double, high: Double, unit: String): String? =
    if (value.isNaN()) null else rangeProblem(what, value, low, high, unit)

private fun rangeProblem(what: String, value: Double, low: Double, high: Double, unit: String): String? {
    val isInside = value >= low - MissionLimits.TOLERANCE && value <= high + MissionLimits.TOLERANCE
    return if (isInside) null else "$what must be ${shown(low)} to ${shown(high)} $unit; got ${shown(value)}"
}

/** Why DJI's waypoint missions cannot fly a plan, as a sentence, or null. */
fun planProblem(plan: MissionPlan): String? {
    val count = plan.points.size
    if (count < MissionLimits.LEAST_WAYPOINTS || count > MissionLimits.MOST_WAYPOINTS) {
        return "A mission has ${MissionLimits.LEAST_WAYPOINTS} to ${MissionLimits.MOST_WAYPOINTS} waypoints; got $count"
    }
    return spacingProblem(plan) ?: if (plan.isCurved) curveProblem(plan) else null
}

private fun spacingProblem(plan: MissionPlan): String? {
    val lengths = plan.points.zipWithNext(::distanceM)
    // The way from the last waypoint to the first is checked too, though it is not flown.
    val closed = lengths + distanceM(plan.points.last(), plan.points.first())
    val wrong = closed.firstOrNull { it < MissionLimits.CLOSEST_M || it > MissionLimits.FARTHEST_M }
    val pathM = lengths.sum()
    return when {
        wrong != null ->
            "Waypoints must be ${shown(MissionLimits.CLOSEST_M)} to ${shown(MissionLimits.FARTHEST_M)} m apart; " +
                "got ${shown(wrong)} m"
        pathM > MissionLimits.LONGEST_PATH_M ->
            "A mission's path is at most ${shown(MissionLimits.LONGEST_PATH_M)} m; got ${shown(pathM)} m"
        else -> null
    }
}

private fun curveProblem(plan: MissionPlan): String? {
    val withAction = plan.points.indexOfFirst { it.loiterS != null || it.gimbalPitchDeg != null }
    if (withAction >= 0) {
        return "Waypoint ${withAction + 1}: a curved mission does not stop, so it has no loiter or gimbal action"
    }
    val inner = plan.points.drop(1).dropLast(1)
    if (inner.any { !(it.cornerRadiusM > 0.0) }) return "Corner radius of a curved mission must be over 0 m"
    val corners = listOf(0.0) + inner.map { it.cornerRadiusM } + 0.0
    plan.points.zipWithNext(::distanceM).forEachIndexed { leg, lengthM ->
        val sum = corners[leg] + corners[leg + 1]
        if (sum >= lengthM) {
            return "Leg ${leg + 1}: the corner radii at its ends must add to less than its ${shown(lengthM)} m; " +
                "got ${shown(sum)} m"
        }
    }
    return null
}

private fun distanceM(a: PlanPoint, b: PlanPoint): Double =
    distanceM(a.position, a.heightAboveTakeoffM, b.position, b.heightAboveTakeoffM)

internal fun shown(value: Double): String = when {
    value.isNaN() || value.isInfinite() || abs(value) >= 1e9 -> value.toString()
    value == Math.rint(value) -> value.toLong().toString()
    else -> "%.2f".format(java.util.Locale.ROOT, value)
}
