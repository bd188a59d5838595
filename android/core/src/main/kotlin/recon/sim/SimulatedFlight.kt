package recon.sim

import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftFacts
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.Attitude
import recon.aircraft.BatteryWarning
import recon.aircraft.CameraMode
import recon.aircraft.CameraState
import recon.aircraft.Capabilities
import recon.aircraft.Capability
import recon.aircraft.Failsafe
import recon.aircraft.FlightMode
import recon.aircraft.MissionPlan
import recon.aircraft.RtkState
import recon.aircraft.StickSetpoint
import recon.aircraft.VelocityNed
import recon.geo.LatLon
import recon.geo.LocalPlane
import java.util.Random
import kotlin.math.hypot

/** A simulated aircraft as it stands on its pad. */
data class SimulatedSettings(
    val serial: String,
    val home: LatLon,
    /** WGS84, as the aircraft knows it: DJI's is tens of metres off. */
    val takeoffAltitudeM: Double,
    val goHomeHeightM: Double = 40.0,
    /** Minutes of hovering on a full battery. */
    val enduranceMin: Double = 25.0,
    /** Set in the aircraft: missions beyond are accepted and not flown, without a word. */
    val maxHeightM: Double = 500.0,
    val maxDistanceM: Double = 5_000.0,
    val limits: AirframeLimits = AirframeLimits(),
    val capabilities: Capabilities = Capabilities(
        Capability.SUPPORTED, Capability.SUPPORTED, Capability.SUPPORTED, goHomeHeightM, Failsafe.GO_HOME,
    ),
    /** Start in a hover at this height, for tests; null: on the pad. */
    val startHeightM: Double? = null,
)

/**
 * A flying aircraft, without threads or a clock, that behaves like DJI's: it answers a command at once,
 * drops missions beyond its own limits without a word, waits at 0.3 m for a landing confirmation, stops
 * when stick setpoints come too slowly, and obeys no app while its pilot has the mode switch in sport.
 */
class SimulatedFlight(private val settings: SimulatedSettings, startNs: Long) {
    private val plane = LocalPlane(settings.home)
    private var nowNs = startNs
    private var motion = Motion(heightM = settings.startHeightM ?: 0.0)
    private var phase: FlightPhase = if (settings.startHeightM == null) Grounded else Hold()
    /** Where it last took off. */
    private var home = Motion()
    private var charge = 1.0
    private var isVideoOn = false
    private var isCameraLocked = false

    /** Errors of GNSS and barometer: values that never change are those of a hung sensor. */
    private val noise = Random(settings.serial.hashCode().toLong())

    /** The pilot's mode switch is in sport: missions and sticks are refused. */
    var hasPilotControl = false
        private set

    /** Moves in whole ticks up to [nowNs]. */
    fun advance(nowNs: Long) {
        while (this.nowNs + TICK_NS <= nowNs) {
            tick(TICK_NS / 1e9)
            this.nowNs += TICK_NS
        }
    }

    fun pilotTakes() {
        hasPilotControl = true
        if (phase !is Grounded) phase = Hold(FlightMode.SPORT)
    }

    fun pilotReleases() {
        hasPilotControl = false
        if (phase is Hold) phase = Hold()
    }

    fun execute(command: AircraftCommand): Answer = when (command) {
        is AircraftCommand.Hover -> inFlight { Hold() }
        is AircraftCommand.TakeOff -> takeOff()
        is AircraftCommand.Land -> inFlight { phase as? Landing ?: Landing(settings.limits) }
        is AircraftCommand.ConfirmLanding -> confirmLanding()
        is AircraftCommand.GoHome -> inFlight { goHome() }
        is AircraftCommand.FlyMission -> flyMission(command.plan)
        is AircraftCommand.SetStick -> setStick(command.setpoint)
        is AircraftCommand.SetVideo -> Answer.Accepted.also { isVideoOn = command.isOn }
        is AircraftCommand.LockCamera -> Answer.Accepted.also { isCameraLocked = command.isLocked }
    }

    fun state(): AircraftState = AircraftState(
        updatedNs = nowNs,
        serial = settings.serial,
        isSimulated = true,
        isFlying = phase !is Grounded && (phase !is TakeOff || motion.heightM > 0.02),
        flightMode = phase.mode,
        position = plane.position(noisyM(motion.northM), noisyM(motion.eastM)),
        heightAboveTakeoffM = noisyM(motion.heightM),
        takeoffAltitudeM = settings.takeoffAltitudeM,
        velocity = VelocityNed(motion.northMps, motion.eastMps, -motion.upMps),
        attitude = Attitude(motion.yawDeg, 0.0, 0.0),
        gnssSatelliteCount = 17,
        gnssSignalLevel = 5,
        isAtMaxHeight = motion.heightM >= settings.maxHeightM - 0.5,
        isAtMaxDistance = hypot(motion.northM, motion.eastM) >= settings.maxDistanceM - 0.5,
        batteryPercent = Math.round(100.0 * charge).toInt(),
        batteryWarning = batteryWarning(),
        windLevel = 0,
        cameraState = cameraState(),
        needsLandingConfirmation = (phase as? Landing)?.isWaiting ?: false,
        capabilities = settings.capabilities,
        facts = facts(),
    )

    private fun facts() = AircraftFacts(
        home = plane.position(home.northM, home.eastM),
        maxHeightM = settings.maxHeightM,
        maxDistanceM = settings.maxDistanceM,
        model = "simulated",
        rtk = RtkState.OFF,
        cameraMode = CameraMode.PHOTO,
        isExposureLocked = isCameraLocked,
        isWhiteBalanceLocked = isCameraLocked,
        reportsPhotos = false,
        locksCamera = settings.capabilities.camera == Capability.SUPPORTED,
    )

    private fun tick(seconds: Double) {
        if (phase is Grounded) return
        charge = maxOf(0.0, charge - seconds / (60.0 * settings.enduranceMin))
        val demand = phase.demand(motion, seconds)
        val highest = motion.towardsHeightMps(settings.maxHeightM, settings.limits)
        motion = motion.after(demand.copy(upMps = minOf(demand.upMps, highest)), seconds, settings.limits)
        phase.successor(motion)?.let { phase = it }
        if (phase is Grounded) motion = Motion(motion.northM, motion.eastM, yawDeg = motion.yawDeg)
        if (charge < FORCED_LANDING && phase !is Landing && phase !is Grounded) phase = Landing(settings.limits)
    }

    private fun inFlight(next: () -> FlightPhase): Answer {
        if (phase is Grounded) return Answer.Refused("the motors are off")
        // A takeoff that is stopped on the ground stops its motors.
        phase = if (phase is TakeOff && motion.heightM < 0.02) Grounded else next()
        return Answer.Accepted
    }

    private fun takeOff(): Answer {
        if (phase !is Grounded) return Answer.Refused("it is flying already")
        takeOffThen(Hold())
        return Answer.Accepted
    }

    private fun takeOffThen(following: FlightPhase) {
        home = motion
        phase = TakeOff(settings.limits, following)
    }

    private fun goHome() = GoHome(settings.limits, home, settings.goHomeHeightM, motion.heightM)

    private fun confirmLanding(): Answer {
        val landing = phase as? Landing ?: return Answer.Refused("no landing waits for a confirmation")
        landing.isConfirmed = true
        return Answer.Accepted
    }

    private fun flyMission(plan: MissionPlan): Answer {
        if (hasPilotControl) return Answer.Refused("the controller is not in normal mode")
        val isBeyondLimits = plan.points.any {
            it.heightAboveTakeoffM > settings.maxHeightM ||
                hypot(plane.northM(it.position), plane.eastM(it.position)) > settings.maxDistanceM
        }
        if (isBeyondLimits) return Answer.Accepted
        val flight = MissionFlight(plan, plane, settings.limits)
        if (phase is Grounded) takeOffThen(flight) else phase = flight
        return Answer.Accepted
    }

    private fun setStick(setpoint: StickSetpoint): Answer {
        if (hasPilotControl) return Answer.Refused("the controller is not in normal mode")
        return inFlight { Stick(setpoint, settings.limits) }
    }

    private fun noisyM(valueM: Double): Double = valueM + noise.nextGaussian() * NOISE_SIGMA_M

    private fun batteryWarning() = when {
        charge < 0.15 -> BatteryWarning.SERIOUS
        charge < 0.30 -> BatteryWarning.LOW
        else -> BatteryWarning.NONE
    }

    private fun cameraState() = when {
        settings.capabilities.camera != Capability.SUPPORTED -> CameraState.NOT_CONNECTED
        isVideoOn -> CameraState.FEED_ON
        else -> CameraState.FEED_OFF
    }

    private companion object {
        const val TICK_NS = 20_000_000L
        const val FORCED_LANDING = 0.05
        const val NOISE_SIGMA_M = 0.03
    }
}
