package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.Attitude
import recon.aircraft.CameraState
import recon.aircraft.Capabilities
import recon.aircraft.Capability
import recon.aircraft.FlightMode
import recon.aircraft.VelocityNed
import recon.geo.LatLon
import recon.wire.Acknowledgment
import recon.wire.Deframer
import recon.wire.MessageString
import recon.wire.Packet
import recon.wire.encode

const val MS = 1_000_000L
const val SECOND = 1_000 * MS

private val ALL = Capabilities(Capability.SUPPORTED, Capability.SUPPORTED, Capability.SUPPORTED)

/** A real aircraft that hovers at 20 m. */
fun hovering(updatedNs: Long = 0, mode: FlightMode = FlightMode.GPS_ATTI) = AircraftState(
    updatedNs = updatedNs,
    serial = "1581F5BKD22BJ00A",
    isFlying = true,
    flightMode = mode,
    position = LatLon(45.0, -93.0),
    heightAboveTakeoffM = 20.0,
    takeoffAltitudeM = 280.0,
    velocity = VelocityNed(0.0, 0.0, 0.0),
    attitude = Attitude(90.0, 0.0, 0.0),
    cameraState = CameraState.FEED_OFF,
    capabilities = ALL,
)

fun standing(updatedNs: Long = 0) = hovering(updatedNs).copy(isFlying = false, heightAboveTakeoffM = 0.0)

/** A session with a clock of its own, an aircraft that answers as the test wants, and a station that reads. */
class Harness(settings: SessionSettings = SessionSettings(), private val isReading: Boolean = true) {
    val session = CompanionSession(settings)
    var nowNs = 0L
        private set
    val executed = mutableListOf<Output.Execute>()
    val outputs = mutableListOf<Output>()
    val sent = mutableListOf<Pair<Long, Packet>>()
    var state: AircraftState? = hovering()

    /** The answer given at once; null: the test calls [answer]. */
    var answers: Answer? = Answer.Accepted
    private val station = Deframer()

    val commands: List<AircraftCommand> get() = executed.map { it.command }
    val acknowledgments: List<Acknowledgment> get() = packets()
    /** Sentences for people. */
    val messages: List<String> get() = texts(isForPeople = true)

    /** Texts of the extension. */
    val appTexts: List<String> get() = texts(isForPeople = false)

    private fun texts(isForPeople: Boolean) =
        packets<MessageString>().filter { (it.type != MessageString.DEBUG) == isForPeople }
            .map { String(it.text.toByteArray(), Charsets.UTF_8) }

    inline fun <reified T : Packet> packets(): List<T> = sent.map { it.second }.filterIsInstance<T>()

    fun connect(): Harness = apply {
        report()
        session.linkOpened(nowNs)
        settle()
        executed.clear()
        sent.clear()
    }

    fun receive(vararg packets: Packet) {
        packets.forEach { session.received(encode(it), nowNs) }
        settle()
    }

    /** Lets time pass in steps of 10 ms; the aircraft reports its state at each. */
    fun pass(ns: Long) {
        val endNs = nowNs + ns
        while (nowNs < endNs) {
            nowNs += minOf(10 * MS, endNs - nowNs)
            report()
            settle()
        }
    }

    /** Lets time pass without a report of the aircraft. */
    fun passInSilence(ns: Long) {
        val endNs = nowNs + ns
        while (nowNs < endNs) {
            nowNs += minOf(10 * MS, endNs - nowNs)
            session.tick(nowNs)
            settle()
        }
    }

    fun answer(call: Output.Execute, answer: Answer) {
        session.answered(call.callId, answer, nowNs)
        settle()
    }

    fun closeLink() {
        session.linkClosed("reset", nowNs)
        settle()
    }

    fun settle() {
        while (true) {
            val news = session.takeOutputs()
            outputs += news
            news.filterIsInstance<Output.Execute>().forEach(::execute)
            val packet = session.nextToSend(nowNs)
            if (packet != null) deliver(packet)
            if (news.isEmpty() && packet == null) return
        }
    }

    private fun report() {
        session.aircraftState(state?.copy(updatedNs = nowNs), nowNs)
    }

    private fun execute(call: Output.Execute) {
        executed += call
        answers?.let { session.answered(call.callId, it, nowNs) }
    }

    private fun deliver(packet: ByteArray) {
        station.push(packet, nowNs)
        while (true) sent += nowNs to (station.poll() ?: break).packet
        if (isReading) session.packetSent(nowNs)
    }
}
