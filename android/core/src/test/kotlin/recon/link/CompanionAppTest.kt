package recon.link

import recon.aircraft.Aircraft
import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.VideoFrame
import recon.geo.LatLon
import recon.session.CompanionSession
import recon.session.HOVER
import recon.session.OrdersTest.Companion.STICK
import recon.session.Output
import recon.session.SessionSettings
import recon.session.Severity
import recon.sim.SimulatedAircraft
import recon.sim.SimulatedSettings
import recon.sim.testPicture
import recon.wire.Acknowledgment
import recon.wire.CameraControl
import recon.wire.CoreTelemetry
import recon.wire.Deframer
import recon.wire.ExtendedTelemetry
import recon.wire.Image
import recon.wire.MessageString
import recon.wire.Packet
import recon.wire.encode
import recon.wire.shownText
import java.net.InetAddress
import java.net.ServerSocket
import java.net.Socket
import java.util.concurrent.CopyOnWriteArrayList
import kotlin.test.AfterTest
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertIs
import kotlin.test.assertTrue

private const val PATIENCE_MS = 30_000

/** Real sockets and threads; the tests wait for what must happen, not for a time. */
class CompanionAppTest {
    private val server = ServerSocket(0, 5, InetAddress.getLoopbackAddress())
    private val notices = CopyOnWriteArrayList<String>()
    private val opened = mutableListOf<AutoCloseable>(server)
    private val settings = SimulatedSettings("SIM-1", LatLon(45.0, -93.0), 280.0, startHeightM = 20.0)

    @AfterTest
    fun close() = opened.reversed().forEach { it.close() }

    @Test
    fun `it introduces itself, executes an order, and acknowledges it`() {
        start(simulated())
        val link = accept()
        assertIs<ExtendedTelemetry>(link.next())
        link.write(HOVER)
        assertEquals(Acknowledgment(1, 255), link.next { it is Acknowledgment })
        assertTrue(link.next { it is CoreTelemetry } is CoreTelemetry)
        assertTrue("Connected to the station" in notices)
    }

    @Test
    fun `it connects again when the station closes, and begins with its identity`() {
        start(simulated())
        accept().close()
        assertIs<ExtendedTelemetry>(accept().next())
        assertTrue(notices.any { it.startsWith("Link to the station lost") })
    }

    @Test
    fun `it sends frames that are asked for, as packets of the chosen kind`() {
        start(simulated())
        val link = accept()
        link.write(CameraControl(CameraControl.START, 10f))
        val image = link.next { it is Image } as Image
        assertEquals(2 to 4, image.rows to image.cols)
        link.write(CameraControl(CameraControl.STOP, 0f))
        assertEquals(Acknowledgment(1, 254), link.next { it is Acknowledgment })
    }

    @Test
    fun `without a station it reports that once, and keeps trying`() {
        server.close()
        start(simulated())
        await { notices.isNotEmpty() }
        assertEquals(1, notices.count { it.startsWith("No station: ") })
    }

    @Test
    fun `release and permission of control reach the station`() {
        val companion = start(simulated())
        val link = accept()
        // A release before the link has opened is part of the introduction instead.
        assertIs<ExtendedTelemetry>(link.next())
        companion.releaseControl()
        assertTrue(link.message { it.startsWith("Control released") }.isNotEmpty())
        companion.allowControl()
        assertTrue(link.message { it == "The station may command again" }.isNotEmpty())
    }

    @Test
    fun `control released before the first link is reported by the introduction`() {
        start(simulated()) { it.releaseControl() }
        assertTrue(accept().message { it.endsWith("control released to the pilot") }.isNotEmpty())
    }

    @Test
    fun `a sentence about the phone reaches the station and the person`() {
        val companion = start(simulated())
        val link = accept()
        assertIs<ExtendedTelemetry>(link.next())
        companion.report(Severity.WARNING, "Phone battery 12 %")
        assertEquals("Phone battery 12 %", link.message { it.startsWith("Phone") })
        assertTrue("Phone battery 12 %" in notices)
    }

    @Test
    fun `closing the app ends what the aircraft flies for the station`() {
        val aircraft = simulated()
        val commands = CopyOnWriteArrayList<AircraftCommand>()
        val recorded = object : Aircraft by aircraft {
            override fun execute(command: AircraftCommand, answered: (Answer) -> Unit) {
                commands.add(command)
                aircraft.execute(command, answered)
            }
        }
        val companion = start(recorded)
        val link = accept()
        link.write(STICK.copy(timeoutS = 30f))
        assertEquals(Acknowledgment(1, STICK.pid), link.next { it is Acknowledgment })
        companion.close()
        assertIs<AircraftCommand.SetStick>(commands.first())
        assertEquals(AircraftCommand.Hover, commands.last())
    }

    @Test
    fun `garbage from the station changes nothing`() {
        start(simulated())
        val link = accept()
        repeat(20) { link.socket.getOutputStream().write(ByteArray(10_000) { (it * 7).toByte() }) }
        link.socket.getOutputStream().write(encode(HOVER))
        assertEquals(Acknowledgment(1, 255), link.next { it is Acknowledgment })
    }

    @Test
    fun `an error in the app's own code costs one step and is shown`() {
        val broken = object : Aircraft {
            override fun state(): AircraftState? = null

            override fun execute(command: AircraftCommand, answered: (Answer) -> Unit) = error("broken adapter")

            override fun onFrame(listener: ((VideoFrame) -> Unit)?) = Unit
        }
        start(broken)
        val link = accept()
        link.write(HOVER)
        await { notices.any { "broken adapter" in it } }
        assertTrue(link.next { it is ExtendedTelemetry } is ExtendedTelemetry)
    }

    @Test
    fun `a station that stops reading loses its link, with a sentence`() {
        val aircraft = SimulatedAircraft(settings, testPicture(640, 360)).also { opened.add(it) }
        start(aircraft, SessionSettings(stalledWriteNs = 200_000_000))
        val link = accept()
        link.write(CameraControl(CameraControl.START, 10f))
        // Nothing is read from here on: the socket fills.
        await { notices.any { "has not read" in it } }
        assertIs<ExtendedTelemetry>(accept().next())
    }

    private fun simulated() = SimulatedAircraft(settings, testPicture(4, 2)).also { opened.add(it) }

    private fun start(
        aircraft: Aircraft,
        settings: SessionSettings = SessionSettings(),
        beforeStart: (CompanionApp) -> Unit = {},
    ): CompanionApp {
        val listener = object : CompanionListener {
            override fun notice(notice: Output.Notice) {
                notices.add(notice.text)
            }

            override fun changed(session: CompanionSession) {
                check(session.dueNs > 0)
            }
        }
        val address = StationAddress("127.0.0.1", server.localPort)
        return CompanionApp(settings, aircraft, address, RawFrameEncoder, listener).also {
            opened.add(it)
            beforeStart(it)
            it.start()
        }
    }

    private fun accept() = StationEnd(server.apply { soTimeout = PATIENCE_MS }.accept()).also { opened.add(it) }

    private fun await(isSo: () -> Boolean) {
        val endNs = System.nanoTime() + PATIENCE_MS * 1_000_000L
        while (!isSo()) {
            check(System.nanoTime() < endNs) { "not seen within $PATIENCE_MS ms; notices: $notices" }
            Thread.sleep(5)
        }
    }
}

/** The station's end of one link. */
private class StationEnd(val socket: Socket) : AutoCloseable {
    private val deframer = Deframer()

    init {
        socket.soTimeout = PATIENCE_MS
    }

    fun write(packet: Packet) = socket.getOutputStream().write(encode(packet))

    /** The next packet that is wanted; telemetry never stops coming, so the wait has an end. */
    fun next(isWanted: (Packet) -> Boolean = { true }): Packet {
        val buffer = ByteArray(65_536)
        val endNs = System.nanoTime() + PATIENCE_MS * 1_000_000L
        while (true) {
            check(System.nanoTime() < endNs) { "no such packet within $PATIENCE_MS ms" }
            val packet = deframer.poll()?.packet
            if (packet != null && isWanted(packet)) return packet
            if (packet == null) {
                val count = socket.getInputStream().read(buffer)
                check(count >= 0) { "closed by the app" }
                deframer.push(buffer, System.nanoTime(), 0, count)
            }
        }
    }

    fun message(isWanted: (String) -> Boolean): String {
        val found = next { it is MessageString && isWanted(it.text.shownText()) } as MessageString
        return found.text.shownText()
    }

    override fun close() = socket.close()
}
