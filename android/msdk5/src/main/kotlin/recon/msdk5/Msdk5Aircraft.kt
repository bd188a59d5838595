package recon.msdk5

import recon.aircraft.Aircraft
import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.FlightMode
import recon.aircraft.MissionAction
import recon.aircraft.MissionPlan
import recon.aircraft.ReleasedPhoto
import recon.aircraft.StickSetpoint
import recon.aircraft.VideoFrame

/**
 * A DJI aircraft by Mobile SDK 5.
 *
 * Theory of operation. Each command becomes steps (`OrderSteps`); the first that fails is the answer. Whatever
 * the aircraft flies is ended first: sticks, mission, return, landing or takeoff, each by its own call, as the
 * state shows it. What had ended already is no failure, and neither is anything that a landing or a return
 * replaces.
 *
 * Virtual stick runs in velocity mode. The height is held here, by a vertical velocity in proportion to
 * the error: DJI's position mode was reported to climb by the height each time it is sent. An attempt to
 * enable it that DJI never answers is given up after 5 s.
 */
class Msdk5Aircraft(
    private val sdk: DjiSdk, private val clockNs: () -> Long, private val clockMs: () -> Long,
) : Aircraft {
    private val monitor = Any()
    private val orders = OrderSteps(monitor, clockNs, LONGEST_ORDER_NS)
    private val lock = CameraLock(sdk)
    private val releases = PhotoReleases()
    private var missions = 0
    private var missionName: String? = null
    private var listener: ((VideoFrame) -> Unit)? = null
    private var isVideoOn = false
    private var setpoint: StickSetpoint? = null
    private var enablingUntilNs: Long? = null

    /** Number of the order that flies by sticks; 0 before the first. */
    private var stickOrder = 0
    private var readings = DjiReadings()
    private var readingsNs: Long? = null
    private var readingsSerial: String? = null

    override fun state(): AircraftState? = synchronized(monitor) {
        sdk.snapshot()?.let { aircraftState(it, isVideoOn, factsOf(it, readings(it.serial))) }
    }

    override fun onFrame(listener: ((VideoFrame) -> Unit)?) = synchronized(monitor) { this.listener = listener }

    override fun onPhoto(listener: ((ReleasedPhoto) -> Unit)?) =
        sdk.onCamera(listener?.let { { event -> completed(event)?.let(listener) } })

    override fun execute(command: AircraftCommand, answered: (Answer) -> Unit): Unit = synchronized(monitor) {
        when (command) {
            is AircraftCommand.Hover -> orders.run(endMotion(), answered)
            is AircraftCommand.TakeOff -> orders.run(listOf(action(FlightAction.START_TAKEOFF)), answered)
            is AircraftCommand.Land -> begin(FlightAction.START_AUTO_LANDING, LANDING_MODES, answered)
            is AircraftCommand.GoHome -> begin(FlightAction.START_GO_HOME, setOf(FlightMode.GO_HOME), answered)
            // Part of the landing that goes on: it ends nothing and is no newer order.
            is AircraftCommand.ConfirmLanding ->
                orders.runBeside(listOf(action(FlightAction.CONFIRM_LANDING)), answered)
            is AircraftCommand.FlyMission -> flyMission(command.plan, answered)
            is AircraftCommand.SetStick -> setStick(command.setpoint, answered)
            is AircraftCommand.SetVideo -> setVideo(command.isOn, answered)
            is AircraftCommand.LockCamera -> {
                readingsNs = null
                orders.runBeside(lock.steps(command.isLocked, readings(readingsSerial).whiteBalance), answered)
            }
        }
    }

    /** Begins a landing or a return, unless it goes on already: beginning it again would interrupt it. */
    private fun begin(action: FlightAction, modes: Set<FlightMode>, answered: (Answer) -> Unit) {
        val goesOn = sdk.snapshot()?.mode in modes
        orders.run(if (goesOn) emptyList() else endMotion().map { it.optional() } + action(action), answered)
    }

    private fun flyMission(plan: MissionPlan, answered: (Answer) -> Unit) {
        val snapshot = sdk.snapshot()
        val file = MissionFile(plan, snapshot, readings(snapshot?.serial), clockMs())
        file.problem()?.let { return answered(Answer.Refused(it, action = MissionAction.UPLOAD)) }
        // A name of another run of the app could still be on the aircraft.
        val name = "recon-${clockMs() / MS_PER_S}-${++missions}"
        val check = sdk.checkMission(name, file.kmz)
        if (check is FileCheck.Faulty) return answered(refusedFile(check))
        val steps = endMotion() + listOf(
            Step({ refusalOf(MissionAction.UPLOAD, it) }) { done -> sdk.pushMission(name, file.kmz, done) },
            Step({ refusalOf(MissionAction.START, it) }) { done ->
                missionName = name
                sdk.startMission(name, done)
            },
        )
        orders.run(steps) { answered(if (it is Answer.Accepted) Answer.Noted(file.note(check)) else it) }
    }

    private fun refusedFile(check: FileCheck.Faulty) = Answer.Refused(
        "Not uploaded: DJI's check of the file found ${faultWords(check.numbers)}. To try: another shape of this " +
            "mission, or its plan as a file in DJI's own app",
        "${check.numbers.first()}",
        MissionAction.UPLOAD,
    )

    private fun setStick(setpoint: StickSetpoint, answered: (Answer) -> Unit) {
        this.setpoint = setpoint
        val isRepeat = orders.newest == stickOrder
        if (sdk.snapshot()?.isVirtualStickEnabled == true) {
            // A mission that is being uploaded would start all the same.
            if (!isRepeat) stickOrder = orders.run(emptyList()) {}
            sendStick()
            return answered(Answer.Accepted)
        }
        // Repeats while virtual stick is being enabled: the newest setpoint is sent when it is.
        if (isEnabling && isRepeat) return answered(Answer.Accepted)
        val untilNs = clockNs() + LONGEST_ENABLING_NS
        enablingUntilNs = untilNs
        stickOrder = orders.run(endMotion(keepsSticks = true) + Step { sdk.enableVirtualStick(it) }) { answer ->
            if (enablingUntilNs == untilNs) enablingUntilNs = null
            if (answer is Answer.Accepted) sendStick()
            answered(answer)
        }
    }

    private val isEnabling: Boolean get() = enablingUntilNs?.let { clockNs() < it } ?: false

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

    private fun completed(event: CameraEvent): ReleasedPhoto? = synchronized(monitor) {
        val snapshot = sdk.snapshot()
        val now = ReleasedPhoto(
            clockNs(), clockMs(), snapshot?.serial?.ifBlank { null }, snapshot?.let { position(it) },
            snapshot?.altitudeM, snapshot?.yawDeg, snapshot?.gimbalPitchDeg,
            LENSES[snapshot?.model?.number?.camera?.lens],
        )
        releases.of(event, now)
    }

    /** Read once a second, and at once for another aircraft: its facts are not those of the one before. */
    private fun readings(serial: String?): DjiReadings {
        val nowNs = clockNs()
        val isFresh = readingsNs?.let { nowNs - it < READ_PERIOD_NS } ?: false
        if (!isFresh || serial != readingsSerial) {
            readings = sdk.readings()
            readingsNs = nowNs
            readingsSerial = serial
        }
        return readings
    }

    /** The steps that end what the aircraft flies now. */
    private fun endMotion(keepsSticks: Boolean = false): List<Step> {
        val snapshot = sdk.snapshot()
        val steps = mutableListOf<Step>()
        if (!keepsSticks && (snapshot?.isVirtualStickEnabled == true || isEnabling)) steps += Step { endSticks(it) }
        val mission = snapshot?.missionName ?: missionName
        if (snapshot?.isMissionActive == true && mission != null) steps += endMission { sdk.stopMission(mission, it) }
        else if (snapshot?.isMissionFlown == true) steps += endMission { sdk.pauseMission(it) }
        STOP_ACTIONS[snapshot?.mode]?.let { steps += action(it) }
        return steps
    }

    private fun endMission(start: (Done) -> Unit) =
        Step({ if (it.code in NOT_RUNNING) null else refusalOf(it) }, start)

    private fun endSticks(done: Done) {
        setpoint = setpoint?.stopped
        sendStick()
        setpoint = null
        sdk.disableVirtualStick(done)
    }

    private fun action(action: FlightAction) = Step { done -> sdk.perform(action, done) }

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
        private val NOT_RUNNING = setOf("CANNOT_STOP_WAYLINE_WHEN_WAYLINE_NOT_RUNNING", "MISSION_ID_NOT_EXIST")
        private val LENSES = mapOf("wide" to "wide", "visable" to "visible")
        private const val MS_PER_S = 1_000
        private const val READ_PERIOD_NS = 1_000_000_000L
        private const val LONGEST_ENABLING_NS = 5_000_000_000L

        /** Just below the time after which the session tells the operator that there is no answer. */
        private const val LONGEST_ORDER_NS = 19_000_000_000L

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
