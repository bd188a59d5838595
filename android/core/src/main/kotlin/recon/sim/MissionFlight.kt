package recon.sim

import recon.aircraft.FlightMode
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import recon.geo.LocalPlane
import kotlin.math.abs
import kotlin.math.atan2
import kotlin.math.hypot
import kotlin.math.sqrt

/**
 * A waypoint mission: climb to the first height, then leg by leg. At each waypoint it stops, with loiter;
 * a curved mission turns to the next leg from the corner radius on, without a stop.
 */
class MissionFlight(
    private val plan: MissionPlan,
    private val plane: LocalPlane,
    private val limits: AirframeLimits,
) : FlightPhase {
    private var next = 0
    private var hasRisen = false
    private var loiterLeftS: Double? = null

    override val mode get() = FlightMode.WAYPOINT

    override fun demand(motion: Motion, seconds: Double): VelocityDemand {
        val target = plan.points.getOrNull(next) ?: return VelocityDemand()
        if (!hasRisen) return rise(motion, target)
        loiterLeftS?.let { return loiter(it - seconds) }
        if (isReached(motion, target)) return reached(target)
        return pursue(motion, target)
    }

    override fun successor(motion: Motion): FlightPhase? = when {
        next < plan.points.size || motion.groundSpeedMps > ARRIVED_MPS -> null
        plan.landsAtEnd -> Landing(limits)
        else -> Hold()
    }

    private fun rise(motion: Motion, target: PlanPoint): VelocityDemand {
        hasRisen = motion.heightM >= target.heightAboveTakeoffM - 1.0
        return VelocityDemand(upMps = motion.towardsHeightMps(target.heightAboveTakeoffM, limits))
    }

    private fun loiter(leftS: Double): VelocityDemand {
        loiterLeftS = leftS.takeIf { it > 0.0 }
        if (loiterLeftS == null) next++
        return VelocityDemand()
    }

    private fun reached(target: PlanPoint): VelocityDemand {
        if (target.loiterS == null) next++ else loiterLeftS = target.loiterS
        return VelocityDemand()
    }

    private val turnsWithoutStop: Boolean get() = plan.isCurved && next in 1 until plan.points.lastIndex

    private fun isReached(motion: Motion, target: PlanPoint): Boolean {
        val distance = distanceM(motion, target)
        if (turnsWithoutStop) return distance < maxOf(target.cornerRadiusM, ARRIVED_M)
        return distance < ARRIVED_M && motion.groundSpeedMps < ARRIVED_MPS
    }

    /** Straight to the waypoint in three dimensions, at the speed of the leg, and stopping there. */
    private fun pursue(motion: Motion, target: PlanPoint): VelocityDemand {
        val north = plane.northM(target.position) - motion.northM
        val east = plane.eastM(target.position) - motion.eastM
        val up = target.heightAboveTakeoffM - motion.heightM
        val distance = distanceM(motion, target)
        val legMps = plan.points[maxOf(0, next - 1)].speedMps
        val speed = if (turnsWithoutStop) legMps else minOf(legMps, brakingSpeedMps(distance, BRAKING_MPS2))
        val steepest = if (up > 0.0) limits.climbMps else limits.descentMps
        val share = minOf(speed / distance, steepest / maxOf(abs(up), 1e-6))
        val yaw = if (hypot(north, east) > 3.0) Math.toDegrees(atan2(east, north)) else null
        return VelocityDemand(north * share, east * share, up * share, yaw)
    }

    private fun distanceM(motion: Motion, target: PlanPoint): Double {
        val north = plane.northM(target.position) - motion.northM
        val east = plane.eastM(target.position) - motion.eastM
        val up = target.heightAboveTakeoffM - motion.heightM
        return sqrt(north * north + east * east + up * up)
    }

    private companion object {
        const val ARRIVED_M = 0.5
        const val ARRIVED_MPS = 0.4
        const val BRAKING_MPS2 = 2.0
    }
}
