package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Capability
import recon.aircraft.StickSetpoint
import recon.mission.PlanResult
import recon.mission.planOf
import recon.mission.reachProblem
import recon.mission.shown
import recon.wire.CameraControl
import recon.wire.EmergencyCommand
import recon.wire.ExecuteWaypointMission
import recon.wire.Packet
import recon.wire.VirtualStickCommand

/** What a command packet means for the aircraft as it is now. */
sealed interface Order {
    /** Pass [command] to the aircraft; [what] names it in sentences. */
    data class Fly(val command: AircraftCommand, val what: String) : Order

    /** A stick with its dead-man's timeout, seconds. */
    data class Stick(val setpoint: StickSetpoint, val timeoutS: Double) : Order

    data class StartVideo(val fpsHz: Float) : Order

    data object StopVideo : Order

    /** Hold exposure and white balance, or give them back. */
    data class Lock(val isLocked: Boolean) : Order

    /** Already as ordered: nothing to do. */
    data class Done(val what: String) : Order

    /** [reason] is a sentence for the operator. */
    data class Refused(val reason: String) : Order
}

/**
 * The meaning of command packets (ICD 3.2). Values out of range, functions that the aircraft does not
 * report, and orders that its state rules out are refused here, each with a sentence.
 */
class Orders(private val settings: SessionSettings) {

    /** The order in a packet, or null when the packet is no command. [state] null: no aircraft, or stale. */
    fun of(packet: Packet, state: AircraftState?): Order? = when (packet) {
        is EmergencyCommand -> emergency(packet, state)
        is CameraControl -> camera(packet, state)
        is ExecuteWaypointMission -> mission(packet, state)
        is VirtualStickCommand -> stick(packet, state)
        else -> null
    }

    private fun emergency(packet: EmergencyCommand, state: AircraftState?): Order = when (packet.action) {
        EmergencyCommand.HOVER -> hover(state)
        EmergencyCommand.LAND -> land(state)
        EmergencyCommand.RETURN_HOME -> goHome(state)
        else -> Order.Refused("Emergency action must be 0, 1 or 2; got ${packet.action}")
    }

    private fun hover(state: AircraftState?): Order {
        // Sent without state too: a stop must not wait, and the aircraft's hover never starts motors.
        if (state == null || !state.isOnGround) return Order.Fly(AircraftCommand.Hover, "Hover")
        if (settings.hoverOnGround == HoverOnGround.TAKEOFF) return Order.Fly(AircraftCommand.TakeOff, "Takeoff")
        return Order.Refused("On the ground: hover is ignored; this app does not take off by hover (a setting)")
    }

    private fun land(state: AircraftState?): Order {
        if (state != null && state.isOnGround) return Order.Done("Land: on the ground already")
        return Order.Fly(AircraftCommand.Land, "Land")
    }

    private fun goHome(state: AircraftState?): Order = when {
        state == null -> Order.Refused(NO_STATE)
        state.isOnGround -> Order.Refused("On the ground: return is ignored, there is nothing to return from")
        else -> Order.Fly(AircraftCommand.GoHome, "Return")
    }

    private fun camera(packet: CameraControl, state: AircraftState?): Order {
        if (packet.action == CameraControl.STOP) return Order.StopVideo
        if (packet.action == CameraControl.LOCK || packet.action == CameraControl.UNLOCK) return lock(packet, state)
        val fps = packet.targetFpsHz
        return when {
            packet.action != CameraControl.START ->
                Order.Refused("Camera action must be 0 to 3; got ${packet.action}")
            !(fps.isFinite() && fps > 0f) -> Order.Refused("Frame rate must be over 0 Hz; got ${shown(fps.toDouble())}")
            state == null -> Order.Refused(NO_STATE)
            else -> lacking(state.capabilities.camera, "camera feed") ?: Order.StartVideo(fps)
        }
    }

    private fun lock(packet: CameraControl, state: AircraftState?): Order = when {
        state == null -> Order.Refused(NO_STATE)
        !state.facts.locksCamera -> Order.Refused("This aircraft's camera cannot be locked by the app")
        else -> Order.Lock(packet.action == CameraControl.LOCK)
    }

    private fun mission(packet: ExecuteWaypointMission, state: AircraftState?): Order {
        if (state == null) return Order.Refused(NO_STATE)
        lacking(state.capabilities.waypointMissions, "waypoint missions")?.let { return it }
        return when (val result = planOf(packet, settings.altitudeReference, state.takeoffAltitudeM)) {
            is PlanResult.Ready -> reachProblem(result.plan, state)?.let { Order.Refused(it) }
                ?: Order.Fly(AircraftCommand.FlyMission(result.plan), "Mission")
            is PlanResult.Refused -> Order.Refused(result.reason)
        }
    }

    private fun stick(packet: VirtualStickCommand, state: AircraftState?): Order {
        if (state == null) return Order.Refused(NO_STATE)
        lacking(state.capabilities.virtualStick, "virtual stick")?.let { return it }
        if (!state.isFlying) return Order.Refused("On the ground: virtual stick does not take off")
        stickProblem(packet)?.let { return Order.Refused(it) }
        val setpoint = StickSetpoint(
            packet.mode == 1,
            packet.yawDeg.toDouble(),
            packet.velocityXMps.toDouble(),
            packet.velocityYMps.toDouble(),
            packet.heightAboveTakeoffM.toDouble(),
        )
        return Order.Stick(setpoint, packet.timeoutS.toDouble())
    }

    private fun stickProblem(packet: VirtualStickCommand): String? {
        if (packet.mode > 1) return "Stick mode must be 0 or 1; got ${packet.mode}"
        if (!(packet.timeoutS > 0f)) return "Stick timeout must be over 0 s; got ${shown(packet.timeoutS.toDouble())}"
        return outside("Stick velocity X", packet.velocityXMps, -FASTEST_MPS, FASTEST_MPS, "m/s")
            ?: outside("Stick velocity Y", packet.velocityYMps, -FASTEST_MPS, FASTEST_MPS, "m/s")
            ?: outside("Stick yaw", packet.yawDeg, -180.0, 180.0, "degrees")
            ?: outside("Stick height", packet.heightAboveTakeoffM, 0.0, HIGHEST_M, "m above takeoff")
            ?: outside("Stick timeout", packet.timeoutS, 0.0, settings.longestStickTimeoutS, "s")
    }

    private fun outside(what: String, value: Float, low: Double, high: Double, unit: String): String? =
        if (value >= low && value <= high) null
        else "$what must be ${shown(low)} to ${shown(high)} $unit; got ${shown(value.toDouble())}"

    private fun lacking(capability: Capability, what: String): Order.Refused? = when (capability) {
        Capability.SUPPORTED -> null
        Capability.UNSUPPORTED -> Order.Refused("This aircraft has no $what")
        Capability.UNKNOWN -> Order.Refused("Not known yet whether this aircraft has $what; try again in a few seconds")
    }

    private companion object {
        const val FASTEST_MPS = 15.0
        const val HIGHEST_M = 500.0
        const val NO_STATE = "No telemetry from the aircraft: check that it is on and linked with its controller"
    }
}
