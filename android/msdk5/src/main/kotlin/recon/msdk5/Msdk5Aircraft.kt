package recon.msdk5

import recon.aircraft.Aircraft
import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.FlightMode
import recon.aircraft.MissionPlan
import recon.aircraft.StickSetpoint
import recon.aircraft.VideoFrame

/**
 * A DJI aircraft by Mobile SDK 5.
 *
 * Theory of operation. Each command becomes steps that follow one another by DJI's callbacks; the first
 * that fails is the answer. Whatever the aircraft flies is ended first: sticks, mission, return, landing
 * or takeoff, each by its own call, as the state shows it. The newest command wins: steps of an older one
 * that have not begun are dropped, and that command is refused.
 *
 * Virtual stick runs in velocity mode. The height is held here, by a vertical velocity in proportion to
 * the error: DJI's position mode was reported to climb by the height each time it is sent.
 */
class Msdk5Aircraft(private val sdk: DjiSdk, private val clockMs: () -> Long) : Aircraft {
    private var newest = 0
    private var missions = 0
    private var missionName: String? = null
    private var listener: ((VideoFrame) -> Unit)? = null
    private var isVideoOn = false

    @Volatile
    private var setpoint: StickSetpoint? = null
    private var isEnabling = false

    override fun state(): AircraftState? = sdk.snapshot()?.let { aircraftState(it, isVideoOn) }

    @Synchronized
    override fun onFrame(listener: ((VideoFrame) -> Unit)?) {
        this.listener = listener
    }

    @Synchronized
    override fun execute(command: AircraftCommand, answered: (Answer) -> Unit) {
        when (command) {
            is AircraftCommand.Hover -> run(endMotion(), answered)
            is AircraftCommand.TakeOff -> run(listOf(action(FlightAction.START_TAKEOFF)), answered)
            is AircraftCommand.Land -> begin(FlightAction.START_AUTO_LANDING, LANDING_MODES, answered)
            is AircraftCommand.GoHome -> begin(FlightAction.START_GO_HOME, setOf(FlightMode.GO_HOME), answered)
            // Part of the landing that goes on: it ends nothing and is no newer order.
            is AircraftCommand.ConfirmLanding ->
                sdk.perform(FlightAction.CONFIRM_LANDING) { answered(answerOf(it)) }
            is AircraftCommand.FlyMission -> flyMission(command.plan, answered)
            is AircraftCommand.SetStick -> setStick(command.setpoint, answered)
            is AircraftCommand.SetVideo -> setVideo(command.isOn, answered)
        }
    }

    /** Begins a landing or a return, unless it goes on already: beginning it again would interrupt it. */
    private fun begin(action: FlightAction, modes: Set<FlightMode>, answered: (Answer) -> Unit) {
        val goesOn = sdk.snapshot()?.mode in modes
        run(if (goesOn) emptyList() else endMotion() + action(action), answered)
    }

    private fun flyMission(plan: MissionPlan, answered: (Answer) -> Unit) {
        val file = MissionFile(plan, sdk.snapshot(), clockMs())
        file.problem()?.let { return answered(Answer.Refused(it)) }
        val name = "recon-${++missions}"
        val check = sdk.checkMission(name, file.kmz)
        if (check is FileCheck.Faulty) return answered(Answer.Refused(refusedFile(check)))
        val steps = endMotion() + listOf(
            Step({ missionFailure(MissionStep.UPLOAD, it) }) { done -> sdk.pushMission(name, file.kmz, done) },
            Step({ missionFailure(MissionStep.START, it) }) { done ->
                missionName = name
                sdk.startMission(name, done)
            },
        )
        run(steps) { answered(if (it is Answer.Accepted) Answer.Noted(file.note(check)) else it) }
    }

    private fun refusedFile(check: FileCheck.Faulty) =
        "Not uploaded: DJI's check of the file found ${faultWords(check.numbers)}. To try: another shape of this " +
            "mission, or its plan as a file in DJI's own app"

    private fun setStick(setpoint: StickSetpoint, answered: (Answer) -> Unit) {
        this.setpoint = setpoint
        val snapshot = sdk.snapshot()
        if (snapshot?.isVirtualStickEnabled == true) {
            sendStick()
            return answered(Answer.Accepted)
        }
        // Repeats while virtual stick is being enabled: the newest setpoint is sent when it is.
        if (isEnabling) return answered(Answer.Accepted)
        isEnabling = true
        val steps = endMotion(keepsSticks = true) + Step { done -> sdk.enableVirtualStick(done) }
        run(steps) { answer ->
            isEnabling = false
            if (answer is Answer.Accepted) sendStick()
            answered(answer)
        }
    }

    private fun sendStick() {
        val wanted = setpoint ?: return
        val heightM = sdk.snapshot()?.altitudeM
        sdk.sendStick(
            DjiStick(
                wanted.isBodyFrame,
                rollMps = wanted.velocityXMps,
                pitchMps = wanted.velocityYMps,
                yawDeg = wanted.yawDeg,
                verticalMps = verticalMps(wanted.heightAboveTakeoffM, heightM),
            ),
        )
    }

    private fun setVideo(isOn: Boolean, answered: (Answer) -> Unit) {
        isVideoOn = isOn
        sdk.onFrame(if (isOn) ::frame else null)
        answered(Answer.Accepted)
    }

    private fun frame(nv21: ByteArray, width: Int, height: Int) {
        // Frames of odd sides or another length are those of a stream that is being set up.
        if (width % 2 != 0 || height % 2 != 0 || nv21.size != width * height * 3 / 2) return
        listener?.invoke(VideoFrame(width, height, nv21))
    }

    /** The steps that end what the aircraft flies now. */
    private fun endMotion(keepsSticks: Boolean = false): List<Step> {
        val snapshot = sdk.snapshot()
        val steps = mutableListOf<Step>()
        if (!keepsSticks && (snapshot?.isVirtualStickEnabled == true || isEnabling)) steps += Step { endSticks(it) }
        val mission = missionName
        if (mission != null && snapshot?.isMissionActive == true) steps += Step { sdk.stopMission(mission, it) }
        STOP_ACTIONS[snapshot?.mode]?.let { steps += action(it) }
        return steps
    }

    private fun endSticks(done: Done) {
        setpoint = setpoint?.stopped
        sendStick()
        setpoint = null
        sdk.disableVirtualStick(done)
    }

    private fun action(action: FlightAction) = Step { done -> sdk.perform(action, done) }

    private fun run(steps: List<Step>, answered: (Answer) -> Unit) {
        next(steps, ++newest, answered)
    }

    private fun next(steps: List<Step>, command: Int, answered: (Answer) -> Unit) {
        if (steps.isEmpty()) return answered(Answer.Accepted)
        if (command != newest) return answered(Answer.Refused("a newer order came before it was carried out"))
        val step = steps.first()
        step.start(onceDone { error ->
            synchronized(this) {
                if (error == null) next(steps.drop(1), command, answered)
                else answered(Answer.Refused(step.words(error)))
            }
        })
    }

    /** DJI's callbacks have been seen to come twice; only the first counts. */
    private fun onceDone(done: Done): Done {
        var isDone = false
        return { error ->
            if (!isDone) {
                isDone = true
                done(error)
            }
        }
    }

    private fun answerOf(error: DjiError?): Answer =
        if (error == null) Answer.Accepted else Answer.Refused(error.toString())

    /** One call to DJI, and how its failure is told. */
    private class Step(val words: (DjiError) -> String = DjiError::toString, val start: (Done) -> Unit)

    internal companion object {
        private val LANDING_MODES = setOf(FlightMode.AUTO_LANDING, FlightMode.CONFIRM_LANDING)
        private val STOP_ACTIONS = mapOf(
            FlightMode.GO_HOME to FlightAction.STOP_GO_HOME,
            FlightMode.AUTO_LANDING to FlightAction.STOP_AUTO_LANDING,
            FlightMode.CONFIRM_LANDING to FlightAction.STOP_AUTO_LANDING,
            FlightMode.AUTO_TAKEOFF to FlightAction.STOP_TAKEOFF,
            FlightMode.ASSISTED_TAKEOFF to FlightAction.STOP_TAKEOFF,
            FlightMode.MOTORS_JUST_STARTED to FlightAction.STOP_TAKEOFF,
        )

        /** Vertical velocity per metre of error: two seconds to the height, without overshoot. */
        private const val HEIGHT_GAIN_PER_S = 0.5
        private const val FASTEST_VERTICAL_MPS = 3.0

        /** The vertical velocity that leads to a height; 0 while the present height is unknown. */
        fun verticalMps(wantedM: Double, heightM: Double?): Double {
            if (heightM == null || !heightM.isFinite()) return 0.0
            return (HEIGHT_GAIN_PER_S * (wantedM - heightM)).coerceIn(-FASTEST_VERTICAL_MPS, FASTEST_VERTICAL_MPS)
        }
    }
}
