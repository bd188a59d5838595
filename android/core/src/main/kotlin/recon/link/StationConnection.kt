package recon.link

import java.io.IOException
import java.net.InetSocketAddress
import java.net.Socket
import java.util.concurrent.ArrayBlockingQueue
import java.util.concurrent.TimeUnit
import java.util.concurrent.locks.LockSupport

/** What happens on the connection; calls come from its own threads. Links are numbered from 1. */
interface ConnectionListener {
    fun opened(link: Int)

    /** Bytes that the listener may keep; the connection reads on when it returns. */
    fun received(link: Int, bytes: ByteArray)

    fun sent(link: Int)

    fun closed(link: Int, reason: String)

    /** An attempt to connect has failed; the next one follows. */
    fun failed(reason: String)
}

/**
 * The TCP connection to the station, opened again and again until [close].
 *
 * One thread connects and reads, one writes: a station that stops reading blocks only the writer.
 * [tune] sets options of each new socket that depend on the platform.
 */
class StationConnection(
    private val address: StationAddress,
    private val listener: ConnectionListener,
    private val tune: (Socket) -> Unit = {},
) : AutoCloseable {
    private val toWrite = ArrayBlockingQueue<ByteArray>(1)

    private class Link(val number: Int, val socket: Socket)

    @Volatile
    private var link: Link? = null

    @Volatile
    private var isClosed = false

    @Volatile
    private var closeReason: String? = null
    private val reader = Thread(::readUntilClosed, "station-reader").apply { isDaemon = true }
    private val writer = Thread(::writeUntilClosed, "station-writer").apply { isDaemon = true }

    fun start() {
        reader.start()
        writer.start()
    }

    /** Writes one packet; [ConnectionListener.sent] follows. One at a time. */
    fun write(packet: ByteArray) {
        toWrite.offer(packet)
    }

    /** Ends the present link; the next one is opened after a wait. */
    fun reconnect(reason: String) {
        closeReason = reason
        link?.socket?.closeQuietly()
    }

    override fun close() {
        isClosed = true
        reconnect("the app was stopped")
        reader.interrupt()
        writer.interrupt()
        listOf(reader, writer).forEach { it.join(JOIN_MS) }
    }

    private fun readUntilClosed() {
        val backoff = Backoff()
        var number = 0
        try {
            while (!isClosed) {
                val openNs = serveOnce(number + 1)
                if (openNs != null) number++
                LockSupport.parkNanos(backoff.nextWaitNs(openNs ?: 0))
            }
        } catch (_: InterruptedException) {
            // Closed while it waited for its listener.
        }
    }

    /** Connects, and reads to the end of the link; nanoseconds it was open, or null without a link. */
    private fun serveOnce(number: Int): Long? = Socket().use { socket ->
        try {
            connect(socket)
        } catch (error: IOException) {
            listener.failed(error.message ?: "no reason given")
            return null
        }
        val openedNs = System.nanoTime()
        closeReason = null
        toWrite.clear()
        link = Link(number, socket)
        listener.opened(number)
        val reason = readToEnd(number, socket)
        link = null
        listener.closed(number, closeReason ?: reason)
        return System.nanoTime() - openedNs
    }

    private fun readToEnd(number: Int, socket: Socket): String = try {
        read(number, socket)
        "closed by the station"
    } catch (error: IOException) {
        error.message ?: "no reason given"
    }

    private fun connect(opened: Socket) {
        opened.sendBufferSize = SEND_BUFFER_BYTES
        opened.tcpNoDelay = true
        opened.keepAlive = true
        tune(opened)
        opened.connect(InetSocketAddress(address.host, address.port), CONNECT_TIMEOUT_MS)
    }

    private fun read(number: Int, opened: Socket) {
        val buffer = ByteArray(READ_BYTES)
        val input = opened.getInputStream()
        while (!isClosed) {
            val count = input.read(buffer)
            if (count < 0) return
            listener.received(number, buffer.copyOf(count))
        }
    }

    private fun writeUntilClosed() {
        while (!isClosed) {
            try {
                val packet = toWrite.poll(1, TimeUnit.SECONDS) ?: continue
                writeTo(link ?: continue, packet)
            } catch (_: InterruptedException) {
                return
            }
        }
    }

    private fun writeTo(target: Link, packet: ByteArray) {
        try {
            // One packet in one write: some programs take a read for a packet.
            target.socket.getOutputStream().write(packet)
            listener.sent(target.number)
        } catch (_: IOException) {
            // The reader sees the same end and reports it.
            target.socket.closeQuietly()
        }
    }

    private fun Socket.closeQuietly() {
        try {
            close()
        } catch (_: IOException) {
            // Nothing is left to do with a socket that does not close.
        }
    }

    private companion object {
        const val CONNECT_TIMEOUT_MS = 3_000
        const val READ_BYTES = 16_384

        /** Small, so that a station that does not read is noticed before much has piled up. */
        const val SEND_BUFFER_BYTES = 65_536
        const val JOIN_MS = 2_000L
    }
}
