package recon.app

import recon.wire.Deframer
import recon.wire.MessageString
import recon.wire.Packet
import recon.wire.encode
import recon.wire.shownText
import java.net.InetAddress
import java.net.ServerSocket
import java.net.Socket

const val PATIENCE_MS = 30_000

/** A station of one link, on a real socket. */
class Station : AutoCloseable {
    private val server = ServerSocket(0, 5, InetAddress.getLoopbackAddress()).apply { soTimeout = PATIENCE_MS }
    private var socket: Socket? = null
    private var deframer = Deframer()

    val address = "127.0.0.1:${server.localPort}"

    fun accept() {
        socket = server.accept().apply { soTimeout = PATIENCE_MS }
        deframer = Deframer()
    }

    fun send(packet: Packet) = socket!!.getOutputStream().write(encode(packet))

    /** The next packet that is wanted; telemetry never stops coming. */
    fun next(isWanted: (Packet) -> Boolean): Packet {
        val endNs = System.nanoTime() + PATIENCE_MS * 1_000_000L
        val buffer = ByteArray(65_536)
        while (System.nanoTime() < endNs) {
            val packet = deframer.poll()?.packet
            if (packet != null && isWanted(packet)) return packet
            if (packet != null) continue
            val count = socket!!.getInputStream().read(buffer)
            check(count >= 0) { "closed by the app" }
            deframer.push(buffer, System.nanoTime(), 0, count)
        }
        error("no such packet within $PATIENCE_MS ms")
    }

    /** The next message that contains [part]. */
    fun message(part: String): String =
        (next { it is MessageString && part in it.text.shownText() } as MessageString).text.shownText()

    /** Closes the link from the station's side. */
    fun drop() = socket!!.close()

    /** Whether the app has closed the link. */
    fun isAtEnd(): Boolean {
        val buffer = ByteArray(65_536)
        while (socket!!.getInputStream().read(buffer) >= 0) continue
        return true
    }

    override fun close() {
        socket?.close()
        server.close()
    }
}
