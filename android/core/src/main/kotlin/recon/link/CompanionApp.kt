package recon.link

import recon.aircraft.Aircraft
import recon.aircraft.Answer
import recon.aircraft.VideoFrame
import recon.session.CompanionSession
import recon.session.Output
import recon.session.SessionSettings
import recon.session.Severity
import recon.wire.Packet
import recon.wire.shownText
import java.net.Socket
import java.util.concurrent.ExecutorService
import java.util.concurrent.Executors
import java.util.concurrent.LinkedBlockingQueue
import java.util.concurrent.RejectedExecutionException
import java.util.concurrent.Semaphore
import java.util.concurrent.TimeUnit
import java.util.concurrent.atomic.AtomicBoolean

/** What the app's surroundings get to know; calls come from the companion's thread. */
interface CompanionListener {
    fun notice(notice: Output.Notice)

    /** A text of the extension `recon 1` that goes to the station. */
    fun told(text: String) {}

    /** Called about twenty times a second with the session, to be read only during the call. */
    fun changed(session: CompanionSession) {}
}

/**
 * One companion app at work: a session, its aircraft, and the connection to the station.
 *
 * Everything that happens is a task for one thread, which owns the session. The tasks of bytes read
 * are limited, so that a station that sends faster than the app works is slowed down by TCP.
 */
class CompanionApp(
    settings: SessionSettings,
    private val aircraft: Aircraft,
    address: StationAddress,
    private val encoder: FrameEncoder,
    private val listener: CompanionListener,
    tune: (Socket) -> Unit = {},
) : AutoCloseable {
    private val session = CompanionSession(settings)
    private val tasks = LinkedBlockingQueue<(Long) -> Unit>()
    private val reads = Semaphore(MOST_READS)
    private val encoding = Semaphore(1)
    private val encoderThread: ExecutorService =
        Executors.newSingleThreadExecutor { Thread(it, "encoder").apply { isDaemon = true } }
    private val connection = StationConnection(address, Events(), tune)
    private val thread = Thread(::run, "companion").apply { isDaemon = true }
    private val isFrameWaiting = AtomicBoolean()
    private var openLink = 0
    private var lastProblem = ""
    private var sentPackets = 0L

    @Volatile
    private var isClosed = false

    fun start() {
        aircraft.onFrame(::frameTaken)
        aircraft.onPhoto { photo -> tasks.add { session.photoTaken(photo, it) } }
        // Before the first link, which begins with the aircraft's identity.
        session.aircraftState(aircraft.state(), System.nanoTime())
        thread.start()
        connection.start()
    }

    /** The person beside the phone takes the aircraft from the station. */
    fun releaseControl() = tasks.add { session.releaseControl(it) }

    fun allowControl() = tasks.add { session.allowControl(it) }

    /** A sentence about the phone, for the station and the person beside it. */
    fun report(severity: Severity, text: String) = tasks.add { session.report(severity, text, it) }

    /** Ends the app, and with a hover what the aircraft flies for the station: no station could stop it later. */
    override fun close() {
        isClosed = true
        aircraft.onFrame(null)
        aircraft.onPhoto(null)
        thread.join(JOIN_MS)
        connection.close()
        encoderThread.shutdownNow()
    }

    private fun run() {
        while (!isClosed) isolated(::step)
        isolated {
            session.releaseControl(System.nanoTime())
            session.takeOutputs().filterIsInstance<Output.Execute>().forEach(::carryOut)
        }
        listener.notice(Output.Notice(Severity.INFO, "Ended: $sentPackets packets sent"))
    }

    /** An error in the app's own code costs one step; the aircraft must not lose its app. */
    private fun isolated(step: () -> Unit) {
        try {
            step()
        } catch (error: RuntimeException) {
            listener.notice(Output.Notice(Severity.ERROR, "Error in the app: ${shownText(error.toString())}"))
        }
    }

    private fun step() {
        val waitNs = (session.dueNs - System.nanoTime()).coerceIn(0, LONGEST_WAIT_NS)
        val task = tasks.poll(waitNs, TimeUnit.NANOSECONDS)
        // State first: after a pause of the app the session must not judge by what it knew before.
        session.aircraftState(aircraft.state(), System.nanoTime())
        task?.invoke(System.nanoTime())
        session.takeOutputs().forEach(::carryOut)
        session.nextToSend(System.nanoTime())?.let(::send)
        listener.changed(session)
    }

    private fun send(packet: ByteArray) {
        sentPackets++
        connection.write(packet)
    }

    /** One frame waits at most: a busy companion must not collect the feed. */
    private fun frameTaken(frame: VideoFrame) {
        if (!isFrameWaiting.compareAndSet(false, true)) return
        tasks.add { now ->
            isFrameWaiting.set(false)
            session.frameTaken(frame, now)
        }
    }

    private fun carryOut(output: Output) {
        when (output) {
            is Output.Execute -> aircraft.execute(output.command) { answered(output.callId, it) }
            is Output.Encode -> encode(output)
            is Output.CloseLink -> connection.reconnect(output.reason)
            is Output.Notice -> listener.notice(output)
            is Output.Told -> listener.told(output.text)
        }
    }

    private fun answered(callId: Long, answer: Answer) {
        tasks.add { session.answered(callId, answer, it) }
    }

    /** Encodes one frame at a time: with the encoder busy, the newer frame waits for the next turn. */
    private fun encode(asked: Output.Encode) {
        if (!encoding.tryAcquire()) return
        try {
            encoderThread.execute {
                try {
                    val packet: Packet = encoder.encode(asked.frame, asked.targetFpsHz, asked.quality)
                    tasks.add { session.imageEncoded(packet) }
                } finally {
                    encoding.release()
                }
            }
        } catch (_: RejectedExecutionException) {
            encoding.release()
        }
    }

    /** Tasks of a link that has ended are dropped: they must not touch the next one. */
    private inner class Events : ConnectionListener {
        override fun opened(link: Int) {
            tasks.add { now ->
                openLink = link
                lastProblem = ""
                session.linkOpened(now)
            }
        }

        override fun received(link: Int, bytes: ByteArray) {
            reads.acquire()
            tasks.add { now ->
                reads.release()
                if (link == openLink) session.received(bytes, now)
            }
        }

        override fun sent(link: Int) {
            tasks.add { now -> if (link == openLink) session.packetSent(now) }
        }

        override fun closed(link: Int, reason: String) {
            tasks.add { now -> if (link == openLink) session.linkClosed(reason, now) }
        }

        override fun failed(reason: String) {
            tasks.add { noticeNoStation(reason) }
        }
    }

    /** Attempts that fail alike are reported once. */
    private fun noticeNoStation(reason: String) {
        if (reason == lastProblem) return
        lastProblem = reason
        listener.notice(Output.Notice(Severity.WARNING, "No station: $reason"))
    }

    private companion object {
        const val LONGEST_WAIT_NS = 50_000_000L
        const val MOST_READS = 8
        const val JOIN_MS = 2_000L
    }
}
