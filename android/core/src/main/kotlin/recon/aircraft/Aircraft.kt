package recon.aircraft

import recon.geo.LatLon

/**
 * The aircraft as the session commands it: DJI's SDK behind an adapter, or a simulated one.
 *
 * Calls come from one thread. [execute] returns at once; the answer comes once, from any thread, when
 * the aircraft has accepted or refused the command. Acceptance is not execution: state shows that.
 */
interface Aircraft {
    /** The newest state, or null while no aircraft is connected. */
    fun state(): AircraftState?

    fun execute(command: AircraftCommand, answered: (Answer) -> Unit)

    /** Passes every frame of the camera feed to [listener], from any thread, until replaced by null. */
    fun onFrame(listener: ((VideoFrame) -> Unit)?)

    /** Passes every photo that the camera has confirmed to [listener], from any thread, until replaced by null. */
    fun onPhoto(listener: ((ReleasedPhoto) -> Unit)?) {}
}

/** What the session asks of an aircraft. Each ends what the aircraft did before; none takes off but [TakeOff]. */
sealed interface AircraftCommand {
    /** Stop mission, return, landing or sticks, and hold position. Never starts motors. */
    data object Hover : AircraftCommand

    /** Start motors, climb to the aircraft's own takeoff height, hover. */
    data object TakeOff : AircraftCommand

    data object Land : AircraftCommand

    /** Continue a landing that waits at 0.3 m. */
    data object ConfirmLanding : AircraftCommand

    /** Climb to the go-home height set in the aircraft, fly home, land. */
    data object GoHome : AircraftCommand

    data class FlyMission(val plan: MissionPlan) : AircraftCommand

    /** Fly one setpoint; the session repeats it ten times a second. */
    data class SetStick(val setpoint: StickSetpoint) : AircraftCommand

    data class SetVideo(val isOn: Boolean) : AircraftCommand

    /** Hold exposure and white balance as they are, or give them back; state shows what is held. */
    data class LockCamera(val isLocked: Boolean) : AircraftCommand

    /** Whether it moves the aircraft, or ends what moves it. */
    val isMotion: Boolean get() = this !is SetVideo && this !is LockCamera && this !is ConfirmLanding
}

/** The steps of a mission on its way: to the aircraft, into it, and its start. */
enum class MissionAction { UPLOAD, LOAD, START }

/** The aircraft's answer to a command. */
sealed interface Answer {
    data object Accepted : Answer

    /** Accepted, with a sentence for the operator. */
    data class Noted(val note: String) : Answer

    /**
     * [reason] is a sentence for the operator. [code] is that of the aircraft's SDK, and [action] the step of
     * a mission that failed, where they are known.
     */
    data class Refused(val reason: String, val code: String? = null, val action: MissionAction? = null) : Answer
}

/** Velocity setpoint of the virtual stick: heading and height are held, whatever the velocity. */
data class StickSetpoint(
    /** X and Y are forward and right of the aircraft, instead of north and east. */
    val isBodyFrame: Boolean,
    val yawDeg: Double,
    val velocityXMps: Double,
    val velocityYMps: Double,
    val heightAboveTakeoffM: Double,
) {
    /** The same without horizontal velocity. */
    val stopped: StickSetpoint get() = copy(velocityXMps = 0.0, velocityYMps = 0.0)
}

/** A mission in the aircraft's own terms: heights above takeoff, actions or none. */
data class MissionPlan(
    val points: List<PlanPoint>,
    val isCurved: Boolean,
    val landsAtEnd: Boolean,
    /** Seconds between photos that the mission takes from its first waypoint to its last; null: it takes none. */
    val photoEveryS: Double? = null,
)

data class PlanPoint(
    val position: LatLon,
    val heightAboveTakeoffM: Double,
    /** From here to the next point. */
    val speedMps: Double,
    val cornerRadiusM: Double,
    val loiterS: Double? = null,
    val gimbalPitchDeg: Double? = null,
)

/** One frame of the camera feed: NV21 (full-resolution luma, then V and U of 2 x 2 pixels interleaved). */
class VideoFrame(val width: Int, val height: Int, val nv21: ByteArray) {
    init {
        require(width % 2 == 0 && height % 2 == 0) { "NV21 needs even sides; got $width x $height" }
        require(nv21.size == width * height * 3 / 2) { "NV21 of $width x $height; got ${nv21.size} bytes" }
    }
}
