package recon.sim

import recon.aircraft.FlightMode
import recon.aircraft.StickSetpoint
import kotlin.math.atan2
import kotlin.math.hypot

/**
 * What the simulated flight controller flies.
 *
 * Theory of operation. A phase lives while it is flown and may keep timers. At each step the flight asks
 * for its [demand], moves, and asks for its [successor]: null keeps it.
 *
 *     Grounded --(command)--> TakeOff --(1.2 m)--> Hold | MissionFlight
 *     Hold, Stick: until commanded otherwise
 *     MissionFlight --(end)--> Hold | Landing        GoHome --(above home, at rest)--> Landing
 *     Landing --(0.3 m, confirmed, touchdown)--> Grounded
 */
interface FlightPhase {
    val mode: FlightMode

    fun demand(motion: Motion, seconds: Double): VelocityDemand

    fun successor(motion: Motion): FlightPhase?
}

object Grounded : FlightPhase {
    override val mode get() = FlightMode.GPS_ATTI

    override fun demand(motion: Motion, seconds: Double) = VelocityDemand()

    override fun successor(motion: Motion): FlightPhase? = null
}

/** Hold position; [mode] is that of the pilot's switch when the pilot flies. */
class Hold(override val mode: FlightMode = FlightMode.GPS_ATTI) : FlightPhase {
    override fun demand(motion: Motion, seconds: Double) = VelocityDemand()

    override fun successor(motion: Motion): FlightPhase? = null
}

class TakeOff(private val limits: AirframeLimits, private val then: FlightPhase) : FlightPhase {
    private var elapsedS = 0.0

    override val mode get() = FlightMode.AUTO_TAKEOFF

    override fun demand(motion: Motion, seconds: Double): VelocityDemand {
        elapsedS += seconds
        if (elapsedS < SPIN_UP_S) return VelocityDemand()
        return VelocityDemand(upMps = motion.towardsHeightMps(HEIGHT_M, limits))
    }

    override fun successor(motion: Motion): FlightPhase? = then.takeIf { motion.heightM > HEIGHT_M - 0.1 }

    private companion object {
        const val HEIGHT_M = 1.2
        const val SPIN_UP_S = 1.0
    }
}

/** The virtual stick: DJI's aircraft stop when no setpoint has come for [HELD_S]. */
class Stick(private val setpoint: StickSetpoint, private val limits: AirframeLimits) : FlightPhase {
    private var elapsedS = 0.0

    override val mode get() = FlightMode.JOYSTICK

    override fun demand(motion: Motion, seconds: Double): VelocityDemand {
        elapsedS += seconds
        val flown = if (elapsedS > HELD_S) setpoint.stopped else setpoint
        val (north, east) =
            if (flown.isBodyFrame) fromBody(flown.velocityXMps, flown.velocityYMps, motion.yawDeg)
            else Pair(flown.velocityXMps, flown.velocityYMps)
        return VelocityDemand(north, east, motion.towardsHeightMps(flown.heightAboveTakeoffM, limits), flown.yawDeg)
    }

    override fun successor(motion: Motion): FlightPhase? = null

    private companion object {
        /** Below 5 Hz the aircraft hovers; three lost setpoints of 10 Hz are tolerated. */
        const val HELD_S = 0.4
    }
}

class GoHome(
    private val limits: AirframeLimits,
    private val home: Motion,
    goHomeHeightM: Double,
    startHeightM: Double,
) : FlightPhase {
    // Decided once: a descent later must not restart the climb.
    private val heightM = maxOf(goHomeHeightM, startHeightM)
    private var elapsedS = 0.0

    override val mode get() = FlightMode.GO_HOME

    override fun demand(motion: Motion, seconds: Double): VelocityDemand {
        elapsedS += seconds
        val up = motion.towardsHeightMps(heightM, limits)
        if (motion.heightM < heightM - 1.0) return VelocityDemand(upMps = up)
        return towards(motion, home.northM, home.eastM, SPEED_MPS, up)
    }

    override fun successor(motion: Motion): FlightPhase? {
        val awayM = hypot(home.northM - motion.northM, home.eastM - motion.eastM)
        val isHome = awayM < 0.5 && motion.groundSpeedMps < 0.5
        val isHigh = motion.heightM >= heightM - 1.0
        return if (isHome && isHigh && elapsedS >= SHORTEST_S) Landing(limits) else null
    }

    private companion object {
        const val SPEED_MPS = 10.0

        /** Long enough to be in telemetry at 2 Hz, even above home. */
        const val SHORTEST_S = 2.0
    }
}

/** Descends to 0.3 m and waits there for a confirmation, as DJI's firmware does. */
class Landing(private val limits: AirframeLimits) : FlightPhase {
    var isConfirmed = false
    var isWaiting = false
        private set

    override val mode get() = if (isWaiting) FlightMode.CONFIRM_LANDING else FlightMode.AUTO_LANDING

    override fun demand(motion: Motion, seconds: Double): VelocityDemand {
        // Descend only at rest, so that it lands where the command found it.
        if (motion.groundSpeedMps > 0.5) return VelocityDemand()
        isWaiting = !isConfirmed && motion.heightM <= WAITS_AT_M + 0.05
        if (isWaiting) return VelocityDemand()
        if (isConfirmed && motion.heightM <= WAITS_AT_M + 0.1) return VelocityDemand(upMps = -SLOW_MPS)
        val speed = 0.1 + brakingSpeedMps(motion.heightM - WAITS_AT_M, 0.8)
        return VelocityDemand(upMps = -minOf(speed, limits.descentMps))
    }

    override fun successor(motion: Motion): FlightPhase? = Grounded.takeIf { motion.heightM <= 0.0 }

    private companion object {
        const val WAITS_AT_M = 0.3
        const val SLOW_MPS = 0.5
    }
}

private const val BRAKING_MPS2 = 2.0

/** The demand that flies level to a point, nose forward, and stops there. */
internal fun towards(motion: Motion, northM: Double, eastM: Double, speedMps: Double, upMps: Double): VelocityDemand {
    val north = northM - motion.northM
    val east = eastM - motion.eastM
    val distance = hypot(north, east)
    if (distance < 1e-6) return VelocityDemand(upMps = upMps)
    val share = minOf(speedMps, brakingSpeedMps(distance, BRAKING_MPS2)) / distance
    // Near the point the bearing is noise: the heading stays.
    val yaw = if (distance > 3.0) Math.toDegrees(atan2(east, north)) else null
    return VelocityDemand(north * share, east * share, upMps, yaw)
}
