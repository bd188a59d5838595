package recon.app

import android.os.Build
import android.os.Handler
import recon.errors.ReconError
import recon.link.CompanionApp
import recon.link.CompanionListener
import recon.link.StationAddress
import recon.session.CompanionSession
import recon.session.Output
import recon.session.Severity
import java.net.Socket
import java.util.concurrent.Executor
import java.util.concurrent.atomic.AtomicBoolean
import java.util.concurrent.atomic.AtomicReference

/** A sentence with the time it came, milliseconds since 1970. */
data class Message(val atMs: Long, val severity: Severity, val text: String)

/**
 * The process's one companion app: what the screen shows and its buttons do. It outlives activities;
 * `CompanionService` keeps the process running while it is connected.
 *
 * Theory of operation. *Stopped* without a [Run], *running* with one, which connects again automatically.
 * [start] and [stop] change between them; what they begin and end, one after the other, is left to
 * [lifecycle], because a connection takes seconds to give up. Released control outlives both and the
 * process, until the person allows it again. All functions are called on the main thread; the companion's
 * own thread leaves the newest status and the messages, and the main thread takes them.
 */
class CompanionHost(
    private val settings: AppSettings,
    private val source: AircraftSource,
    private val log: FlightLog,
    private val spoken: SpokenWarnings,
    private val tune: (StationAddress, Socket) -> Unit,
    private val lifecycle: Executor,
    private val mainThread: Handler,
    private val clockMs: () -> Long,
) {
    private var run: Run? = null
    private val observers = mutableListOf<() -> Unit>()

    /** Messages that the main thread has not taken yet; under a flood the oldest go. */
    private val arrived = ArrayDeque<Message>()
    private val isNewsPosted = AtomicBoolean()

    /** The newest last, at most [MOST_MESSAGES]. */
    var messages: List<Message> = emptyList()
        private set

    /** Null while it is stopped, and until the session has reported. */
    val status: Status? get() = run?.status

    /** Null while it is stopped. */
    val station: StationAddress? get() = run?.station

    val isReleased: Boolean get() = settings.isReleased

    /** Connects to the stored address, unless it is connected already. Raises [ReconError] when it is no address. */
    fun start() {
        if (run != null) return
        val station = StationAddress.parse(settings.address)
        log.begin()
        log.add("start", "${source.appName}, station $station")
        log.add("start", "${Build.MANUFACTURER} ${Build.MODEL}, Android ${Build.VERSION.RELEASE}")
        val started = Run(station)
        if (settings.isReleased) started.app.releaseControl()
        run = started
        lifecycle.execute(started.app::start)
        notifyObservers()
    }

    /** Ends the connection, and with a hover what the aircraft flies for the station. */
    fun stop() {
        val ended = run ?: return
        run = null
        log.add("stop", "disconnected")
        lifecycle.execute {
            ended.app.close()
            source.close()
        }
        notifyObservers()
    }

    /** Takes the aircraft from the station, with or without a link: only stops are accepted. */
    fun releaseControl() {
        settings.isReleased = true
        run?.app?.releaseControl()
        log.add("pilot", "control released")
        notifyObservers()
    }

    fun allowControl() {
        settings.isReleased = false
        run?.app?.allowControl()
        log.add("pilot", "control allowed")
        notifyObservers()
    }

    /** Shows, speaks and logs a sentence about the phone, and tells the station. */
    fun report(warning: PhoneWarning) {
        run?.app?.report(warning.severity, warning.text)
    }

    /** Calls [changed] on the main thread when there is something new, until [unobserve]. */
    fun observe(changed: () -> Unit) {
        observers += changed
    }

    fun unobserve(changed: () -> Unit) {
        observers -= changed
    }

    private fun notifyObservers() = observers.toList().forEach { it() }

    /** Shows, speaks and logs a sentence, from any thread. */
    private fun report(severity: Severity, text: String) {
        log.add(severity.name.lowercase(), text)
        synchronized(arrived) {
            arrived += Message(clockMs(), severity, text)
            if (arrived.size > MOST_MESSAGES) arrived.removeFirst()
        }
        postNews()
    }

    /** However much comes, one task waits for the main thread. */
    private fun postNews() {
        if (isNewsPosted.compareAndSet(false, true)) mainThread.post(::takeNews)
    }

    private fun takeNews() {
        isNewsPosted.set(false)
        val news = synchronized(arrived) { arrived.toList().also { arrived.clear() } }
        messages = (messages + news).takeLast(MOST_MESSAGES)
        news.forEach { spoken.notice(it.severity, it.text, it.atMs) }
        notifyObservers()
    }

    /** One companion app from start to stop; the listener's functions are called by its thread. */
    private inner class Run(val station: StationAddress) : CompanionListener {
        private val session = settings.session(source.appName, startedS = clockMs() / 1_000)
        val app = CompanionApp(session, source.open(::report), station, JpegEncoder, this) { tune(station, it) }
        private val newest = AtomicReference<Status?>()
        private var loggedNs = 0L

        val status: Status? get() = newest.get()

        override fun notice(notice: Output.Notice) = report(notice.severity, notice.text)

        override fun told(text: String) = log.add("told", text)

        override fun changed(session: CompanionSession) {
            val nowNs = System.nanoTime()
            val status = statusOf(session, nowNs)
            if (status != newest.getAndSet(status)) postNews()
            if (nowNs - loggedNs < LOG_PERIOD_NS) return
            loggedNs = nowNs
            log.add("state", stateLine(session))
        }
    }

    private fun stateLine(session: CompanionSession): String {
        val state = session.state ?: return "no aircraft"
        val place = state.position?.let { "${it.latitudeDeg}, ${it.longitudeDeg}" } ?: "position unknown"
        return "${state.serial}: ${state.flightMode}, $place, ${state.heightAboveTakeoffM} m above takeoff, " +
            "battery ${state.batteryPercent} %, last order: ${session.lastOrder.ifEmpty { "none" }}"
    }

    private companion object {
        const val MOST_MESSAGES = 20
        const val LOG_PERIOD_NS = 1_000_000_000L
    }
}
