package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.ReleasedPhoto
import recon.aircraft.VideoFrame
import recon.wire.ArrivedPacket
import recon.wire.CameraControl
import recon.wire.EmergencyCommand
import recon.wire.ExecuteWaypointMission
import recon.wire.Packet
import recon.wire.VirtualStickCommand
import recon.wire.shownText

/**
 * The app's side of the drone interface for one aircraft, without sockets, threads or a clock.
 *
 * Theory of operation. Its surroundings pass in what happened, each with the time, and carry out the
 * [Output]s: link opened or closed, bytes received, aircraft state, answers, frames, and [tick] when
 * [dueNs] has come. [nextToSend] gives one packet at a time to the socket.
 *
 * - *Identity first.* A link begins with extended telemetry. Core telemetry follows at 10 Hz, extended
 *   at 2 Hz, while the aircraft's state is fresh.
 * - *Orders.* A command packet becomes an [Order] (`Orders`). What the aircraft must do becomes a call
 *   (`Calls`); the acknowledgment is sent when the aircraft has answered, a negative one with a
 *   sentence. A newer order to move supersedes a mission whose answer is still out: accepted late, it
 *   is undone by repeating the newer order.
 * - *Motion.* Sticks are in `StickStream` with the dead-man, the mission in `MissionRun`; each order
 *   to move ends the other. A lost link ends sticks at once with a hover, and a mission as set.
 * - *Extension.* Facts, photos and how actions ended are told in texts of their own (`Extension`).
 * - *Release.* The person beside the phone can take the aircraft from the station at any time; then
 *   only stops are passed on, until control is allowed again.
 *
 * Calls must come from one thread, with a time that does not run backwards.
 */
class CompanionSession(val settings: SessionSettings) {
    private val outputs = ArrayDeque<Output>()
    private val link = StationLink(settings)
    private val orders = Orders(settings)
    private val calls = Calls(settings)
    private val stick = StickStream(settings)
    private val mission = MissionRun(settings)
    private val landing = LandingConfirmation(settings)
    private val video = VideoPacer(settings)
    private val extension = Extension(settings.appName, settings.startedS)
    private var lastMotion: AircraftCommand = AircraftCommand.Hover
    private var wasStale = false

    /** The newest state of the aircraft; null while none is connected. */
    var state: AircraftState? = null
        private set

    /** Whether the person beside the phone has taken the aircraft from the station. */
    var isReleased = false
        private set

    /** The last order of the station, in words; empty before the first. */
    var lastOrder = ""
        private set

    val isLinkOpen: Boolean get() = link.isOpen

    val hasMission: Boolean get() = mission.isRunning || calls.hasMission

    /** Whether sticks of the station move the aircraft, or are being ended. */
    val hasStick: Boolean get() = !stick.isIdle

    /** Images and telemetry packets that gave way to newer ones because the station reads too slowly. */
    val dropped: Pair<Long, Long> get() = link.droppedImages to link.droppedTelemetry

    /** When [tick] has work next, if nothing else happens before. */
    val dueNs: Long get() = listOf(link.dueNs, calls.dueNs, stick.dueNs, mission.dueNs, extension.dueNs).min()

    fun takeOutputs(): List<Output> = outputs.toList().also { outputs.clear() }

    fun linkOpened(nowNs: Long) {
        link.open(nowNs)
        extension.open(nowNs)
        mission.linkRestored()
        if (state?.isSimulated == true) link.report(Severity.INFO, SIMULATED_HELLO, nowNs)
        link.report(Severity.INFO, introduction(), nowNs)
        notice(Severity.INFO, "Connected to the station")
        tick(nowNs)
    }

    fun linkClosed(reason: String, nowNs: Long) {
        if (!link.isOpen) return
        link.close()
        extension.close(nowNs)
        calls.forgetSources()
        if (video.isOn) stopVideo(null, nowNs)
        notice(Severity.WARNING, "Link to the station lost: $reason")
        if (!stick.isIdle) {
            stick.stop()
            fly(AircraftCommand.Hover, "Hover after the loss of the link", null, nowNs)
        }
        if (mission.isRunning) mission.linkLost(nowNs)
    }

    fun received(bytes: ByteArray, nowNs: Long) {
        link.received(bytes, nowNs)
        tick(nowNs)
    }

    fun aircraftState(newest: AircraftState?, nowNs: Long) {
        val isIdentified = newest?.serial != null && newest.serial != state?.serial
        state = newest
        if (newest != null) observe(newest, nowNs)
        if (isIdentified) {
            link.extendedNow(nowNs)
            extension.identified(nowNs)
        }
        tick(nowNs)
    }

    fun answered(callId: Long, answer: Answer, nowNs: Long) {
        val call = calls.end(callId) ?: return answeredLate(callId, answer, nowNs)
        when (answer) {
            is Answer.Accepted -> accepted(call, null, nowNs)
            is Answer.Noted -> accepted(call, shownText(answer.note), nowNs)
            is Answer.Refused -> refused(call, answer.copy(reason = shownText(answer.reason)), nowNs)
        }
        tick(nowNs)
    }

    /** Takes a frame of the camera feed; most are not sent. */
    fun frameTaken(frame: VideoFrame, nowNs: Long) {
        if (link.isOpen && video.takes(nowNs)) {
            outputs.add(Output.Encode(frame, video.targetFpsHz, video.quality))
        }
    }

    /** Takes a photo that the camera has confirmed, with or without a link. */
    fun photoTaken(photo: ReleasedPhoto, nowNs: Long) {
        extension.photoTaken(photo)
        tick(nowNs)
    }

    /** Takes back a frame as the packet that was asked for by [Output.Encode]. */
    fun imageEncoded(packet: Packet) {
        if (video.isOn) link.queueImage(packet)
    }

    /** The next packet to write to the socket, or null; call [packetSent] when it has been written. */
    fun nextToSend(nowNs: Long): ByteArray? = link.nextToSend(nowNs)

    fun packetSent(nowNs: Long) {
        link.sent(nowNs)?.let(video::written)
    }

    /** The person beside the phone takes the aircraft: what the station started ends with a hover. */
    fun releaseControl(nowNs: Long) {
        isReleased = true
        val isMoving = hasStick || hasMission
        endMotion()
        if (isMoving) fly(AircraftCommand.Hover, "Hover for the pilot", null, nowNs)
        report(Severity.WARNING, "Control released to the pilot: only stops are accepted", nowNs)
        tick(nowNs)
    }

    fun allowControl(nowNs: Long) {
        isReleased = false
        report(Severity.INFO, "The station may command again", nowNs)
        tick(nowNs)
    }

    /** Does everything that is due by [nowNs]. */
    fun tick(nowNs: Long) {
        link.tick(nowNs)
        while (true) respond(link.poll() ?: break, nowNs)
        stick.step(nowNs)?.let { flyStick(it, nowNs) }
        checkMission(nowNs)
        checkCalls(nowNs)
        if (!link.isOpen) return
        link.queueTelemetry(state, mission.idFor(state), nowNs)
        for (text in extension.due(freshState(nowNs), nowNs)) {
            link.queueText(text)
            outputs.add(Output.Told(text))
        }
        noticeStaleState(nowNs)
        if (link.isStalled(nowNs)) outputs.add(Output.CloseLink("the station has not read for ${stalledS()} s"))
    }

    private fun respond(arrived: ArrivedPacket, nowNs: Long) {
        val order = orders.of(arrived.packet, freshState(nowNs)) ?: return
        val pid = arrived.packet.pid
        lastOrder = nameOf(arrived.packet)
        val refusal = refusalOf(order)
        if (refusal != null) refuse(pid, refusal, nowNs) else obey(order, arrived, nowNs)
    }

    private fun obey(order: Order, arrived: ArrivedPacket, nowNs: Long) {
        val pid = arrived.packet.pid
        when (order) {
            is Order.Fly -> flyOrder(order, pid, nowNs)
            is Order.Stick -> commandStick(order, arrived, nowNs)
            is Order.StartVideo -> startVideo(order, nowNs)
            is Order.StopVideo -> stopVideo(pid, nowNs)
            is Order.Lock -> fly(AircraftCommand.LockCamera(order.isLocked), "Camera lock", pid, nowNs)
            is Order.Done -> link.acknowledge(pid, isPositive = true)
            is Order.Refused -> refuse(pid, order.reason, nowNs)
        }
    }

    private fun refusalOf(order: Order): String? {
        val isMission = order is Order.Fly && order.command is AircraftCommand.FlyMission
        val isStop = order is Order.Fly && order.command is AircraftCommand.Hover
        val isMotion = order is Order.Fly || order is Order.Stick
        return when {
            isReleased && isMotion && !isStop -> "The pilot has control: released in the app"
            isMotion && !isStop && calls.isFull -> "Too many orders without an answer of the aircraft: wait"
            isMission && calls.hasMission -> "A mission is being uploaded: send the next one when it is answered"
            else -> null
        }
    }

    private fun flyOrder(order: Order.Fly, pid: Int, nowNs: Long) {
        endMotion()
        fly(order.command, order.what, pid, nowNs)
    }

    private fun commandStick(order: Order.Stick, arrived: ArrivedPacket, nowNs: Long) {
        val timesOutNs = arrived.arrivedNs + (order.timeoutS * 1e9).toLong()
        if (timesOutNs <= nowNs) return refuse(arrived.packet.pid, "Stick arrived after its own timeout", nowNs)
        mission.ended()
        calls.supersedeMissions()
        stick.command(order.setpoint, timesOutNs, nowNs)
        fly(AircraftCommand.SetStick(order.setpoint), "Stick", arrived.packet.pid, nowNs)
    }

    private fun startVideo(order: Order.StartVideo, nowNs: Long) {
        video.start(order.fpsHz, nowNs)
        fly(AircraftCommand.SetVideo(isOn = true), "Camera feed", CameraControl.PID, nowNs)
    }

    private fun stopVideo(pid: Int?, nowNs: Long) {
        video.stop()
        link.dropImages()
        fly(AircraftCommand.SetVideo(isOn = false), "Camera feed", pid, nowNs)
    }

    private fun endMotion() {
        stick.stop()
        mission.ended()
        calls.supersedeMissions()
    }

    private fun fly(command: AircraftCommand, what: String, pid: Int?, nowNs: Long) {
        if (command.isMotion) lastMotion = command
        val call = calls.begin(command, what, pid, nowNs)
        outputs.add(Output.Execute(call.id, command))
    }

    private fun flyStick(step: StickStep, nowNs: Long) {
        when (step) {
            is StickStep.Send -> fly(AircraftCommand.SetStick(step.setpoint), "Stick", null, nowNs)
            is StickStep.Release -> {
                fly(AircraftCommand.Hover, "Hover after the stick's timeout", null, nowNs)
                report(Severity.INFO, "No stick command before its timeout: stopped and hovering", nowNs)
            }
            is StickStep.PilotTookOver ->
                report(Severity.WARNING, "Virtual stick ended: the pilot has taken over", nowNs)
        }
    }

    private fun accepted(call: Call, note: String?, nowNs: Long) {
        if (call.isSuperseded) return undo(call, nowNs)
        note?.let { report(Severity.INFO, "${call.what}: $it", nowNs) }
        val command = call.command
        if (command is AircraftCommand.FlyMission) missionAccepted(nowNs)
        if (command.isMotion) landing.ordered(landsAtEnd(command))
        okOutcome(command, mission.number)?.let(extension::ended)
        call.sourcePid?.let { link.acknowledge(it, isPositive = true) }
    }

    /** A mission that was told to have failed must not fly: what was ordered since is repeated, or it hovers. */
    private fun answeredLate(callId: Long, answer: Answer, nowNs: Long) {
        if (!calls.wasGivenUp(callId) || answer is Answer.Refused) return
        report(Severity.WARNING, "Mission accepted after it was given up: it is ended", nowNs)
        val newest = lastMotion.takeUnless { it is AircraftCommand.FlyMission } ?: AircraftCommand.Hover
        fly(newest, "Repeat of the newest order", null, nowNs)
        tick(nowNs)
    }

    private fun missionAccepted(nowNs: Long) {
        mission.accepted(nowNs)
        if (!link.isOpen) mission.linkLost(nowNs)
    }

    private fun refused(call: Call, answer: Answer.Refused, nowNs: Long) {
        if (call.command is AircraftCommand.SetStick) stick.stop()
        if (call.command is AircraftCommand.SetVideo) video.stop()
        failedOutcome(call.command, answer)?.let(extension::ended)
        val text = "${call.what} refused by the aircraft: ${answer.reason}"
        val pid = call.sourcePid
        if (pid != null) refuse(pid, text, nowNs) else report(Severity.ERROR, text, nowNs)
    }

    private fun refuse(pid: Int, reason: String, nowNs: Long) {
        link.acknowledge(pid, isPositive = false)
        report(Severity.WARNING, reason, nowNs)
    }

    /** A mission accepted after a newer order to move: refused, and the newer order repeated. */
    private fun undo(call: Call, nowNs: Long) {
        call.sourcePid?.let { refuse(it, "Mission accepted too late: a newer order holds, and is repeated", nowNs) }
        fly(lastMotion, "Repeat of the newest order", null, nowNs)
    }

    private fun observe(newest: AircraftState, nowNs: Long) {
        stick.observe(newest.flightMode, nowNs)?.let { flyStick(it, nowNs) }
        mission.observe(newest, nowNs)
        if (landing.isDue(newest, nowNs)) fly(AircraftCommand.ConfirmLanding, "Landing confirmation", null, nowNs)
    }

    private fun checkMission(nowNs: Long) {
        if (mission.failedToStart(nowNs)) {
            report(Severity.ERROR, MISSION_NOT_STARTED, nowNs)
            extension.ended(Outcome("mission_start", isOk = false, null, MISSION_NOT_STARTED, mission.number))
        }
        val action = mission.linkLossAction(nowNs) ?: return
        val command = if (action == LinkLossAction.RETURN) AircraftCommand.GoHome else AircraftCommand.Hover
        notice(Severity.WARNING, "No link to the station: the mission ends, ${action.shownName}")
        fly(command, "Order for a lost link", null, nowNs)
    }

    private fun checkCalls(nowNs: Long) {
        for (call in calls.slow(nowNs)) {
            report(Severity.WARNING, "${call.what}: the aircraft has not answered yet", nowNs)
        }
        for (call in calls.expired(nowNs)) giveUp(call, nowNs)
    }

    private fun giveUp(call: Call, nowNs: Long) {
        refused(call, Answer.Refused("no answer"), nowNs)
        val isMission = call.command is AircraftCommand.FlyMission && !call.isSuperseded
        // It may fly all the same, and nobody would know.
        if (isMission) fly(AircraftCommand.Hover, "Hover after a mission without an answer", null, nowNs)
    }

    private fun noticeStaleState(nowNs: Long) {
        val isStale = state != null && freshState(nowNs) == null
        if (isStale && !wasStale) report(Severity.WARNING, TELEMETRY_LOST, nowNs)
        wasStale = isStale
    }

    private fun freshState(nowNs: Long): AircraftState? =
        state?.takeIf { nowNs - it.updatedNs <= settings.stateTimeoutNs }

    /** A sentence for the station and for the person beside the phone. */
    fun report(severity: Severity, text: String, nowNs: Long) {
        link.report(severity, text, nowNs)
        notice(severity, text)
    }

    private fun notice(severity: Severity, text: String) {
        outputs.add(Output.Notice(severity, text))
    }

    private fun introduction(): String =
        "${settings.appName}: waypoint altitude ${settings.altitudeReference.shownName}, " +
            "mission on lost link ${settings.missionOnLinkLoss.shownName}, " +
            "hover on the ground ${settings.hoverOnGround.shownName}" +
            if (isReleased) ", control released to the pilot" else ""

    private fun stalledS(): Long = settings.stalledWriteNs / 1_000_000_000

    private companion object {
        /** First message of a simulated app: the station then marks its vehicle. */
        const val SIMULATED_HELLO = "recon-sim simulated vehicle"
        const val TELEMETRY_LOST = "Telemetry of the aircraft lost: check its controller"
        const val MISSION_NOT_STARTED =
            "The aircraft accepted the mission and did not start it: check its limits and warnings"

        fun landsAtEnd(command: AircraftCommand): Boolean =
            command is AircraftCommand.Land || command is AircraftCommand.GoHome ||
                (command is AircraftCommand.FlyMission && command.plan.landsAtEnd)

        fun nameOf(packet: Packet): String = when (packet) {
            is EmergencyCommand -> listOf("Hover", "Land", "Return").getOrElse(packet.action) { "Emergency" }
            is ExecuteWaypointMission -> "Mission of ${packet.waypoints.size} waypoints"
            is VirtualStickCommand -> "Stick"
            else -> "Camera"
        }
    }
}
