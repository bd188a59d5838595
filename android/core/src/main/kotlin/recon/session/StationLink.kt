package recon.session

import recon.aircraft.AircraftState
import recon.wire.Acknowledgment
import recon.wire.ArrivedPacket
import recon.wire.Bytes
import recon.wire.Deframer
import recon.wire.Limits
import recon.wire.MessageString
import recon.wire.Packet
import recon.wire.encode

/**
 * One connection to the station as packets: what came, and what waits to be sent.
 *
 * A new connection begins with extended telemetry, so that the station knows the aircraft before
 * anything else; core telemetry waits for it.
 */
class StationLink(private val settings: SessionSettings) {
    private val outbox = Outbox()
    private val core = Cadence(settings.corePeriodNs)
    private val extended = Cadence(settings.extendedPeriodNs)
    private var deframer = Deframer(Limits.FROM_STATION)
    private var sendingSinceNs: Long? = null
    private var lastReport = ""
    private var lastReportNs = 0L

    var isOpen = false
        private set

    val droppedImages: Long get() = outbox.droppedImages
    val droppedTelemetry: Long get() = outbox.droppedTelemetry

    val dueNs: Long
        get() = minOf(core.dueNs, extended.dueNs, sendingSinceNs?.plus(settings.stalledWriteNs) ?: Long.MAX_VALUE)

    fun open(nowNs: Long) {
        isOpen = true
        deframer = Deframer(Limits.FROM_STATION)
        outbox.clear()
        sendingSinceNs = null
        lastReport = ""
        core.startAt(nowNs)
        extended.startAt(nowNs)
    }

    fun close() {
        isOpen = false
        // A command behind half a packet must not come out of a link that has ended.
        deframer = Deframer(Limits.FROM_STATION)
        outbox.clear()
        sendingSinceNs = null
        core.stop()
        extended.stop()
    }

    fun received(bytes: ByteArray, nowNs: Long) = deframer.push(bytes, nowNs)

    fun tick(nowNs: Long) = deframer.tick(nowNs)

    fun poll(): ArrivedPacket? = deframer.poll()

    /** The next packet to write; it is being sent until [sent]. Null while one is, or none waits. */
    fun nextToSend(nowNs: Long): ByteArray? {
        if (sendingSinceNs != null) return null
        return outbox.poll()?.also { sendingSinceNs = nowNs }
    }

    /** Takes the news that the packet is written; returns how long that took if it was an image. */
    fun sent(nowNs: Long): Long? {
        val tookNs = sendingSinceNs?.let { nowNs - it }
        sendingSinceNs = null
        return tookNs?.takeIf { outbox.isImagePolled }
    }

    /** Whether one write has taken so long that the station cannot be reading. */
    fun isStalled(nowNs: Long): Boolean = sendingSinceNs?.let { nowNs - it >= settings.stalledWriteNs } ?: false

    /** Queues the telemetry that is due. [state] null: nothing is known of an aircraft; stale state is not sent. */
    fun queueTelemetry(state: AircraftState?, missionId: Int, nowNs: Long) {
        val isStale = state != null && nowNs - state.updatedNs > settings.stateTimeoutNs
        if (extended.isDue(nowNs) && !isStale) outbox.setExtended(encode(extendedTelemetryOf(state, missionId)))
        if (core.isDue(nowNs) && state != null && !isStale) outbox.setCore(encode(coreTelemetryOf(state)))
    }

    /** Sends extended telemetry at once: the identity has become known. */
    fun extendedNow(nowNs: Long) {
        if (isOpen) extended.startAt(nowNs)
    }

    fun acknowledge(sourcePid: Int, isPositive: Boolean) {
        if (isOpen) outbox.addAcknowledgment(encode(Acknowledgment(if (isPositive) 1 else 0, sourcePid)))
    }

    /** Queues a sentence for the operator, unless it repeats the last one. */
    fun report(severity: Severity, text: String, nowNs: Long) {
        if (!isOpen || (text == lastReport && nowNs - lastReportNs < settings.repeatedReportNs)) return
        lastReport = text
        lastReportNs = nowNs
        outbox.addMessage(encode(MessageString(MESSAGE_TYPES.getValue(severity), Bytes.of(text))))
    }

    /** Queues a text that is for the station's program, not for a person. */
    fun queueText(text: String) {
        if (isOpen) outbox.addMessage(encode(MessageString(MessageString.DEBUG, Bytes.of(text))))
    }

    fun queueImage(packet: Packet) {
        if (isOpen) outbox.addImage(encode(packet))
    }

    fun dropImages() = outbox.dropImages()

    private companion object {
        val MESSAGE_TYPES = mapOf(
            Severity.INFO to MessageString.INFO,
            Severity.WARNING to MessageString.WARNING,
            Severity.ERROR to MessageString.ERROR,
        )
    }
}
