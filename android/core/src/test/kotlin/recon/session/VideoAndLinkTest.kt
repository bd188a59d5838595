package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.Answer
import recon.aircraft.FlightMode
import recon.session.OrdersTest.Companion.STICK
import recon.sim.testPicture
import recon.wire.Acknowledgment
import recon.wire.Bytes
import recon.wire.CameraControl
import recon.wire.CompressedImage
import recon.wire.decode
import kotlin.test.Test
import kotlin.test.assertContentEquals
import kotlin.test.assertEquals
import kotlin.test.assertFalse
import kotlin.test.assertNull
import kotlin.test.assertTrue

class VideoAndLinkTest {
    private val frame = testPicture(4, 2)

    @Test
    fun `of thirty frames a second those are sent that the station asks for`() {
        val harness = Harness().connect()
        film(harness, 1 * SECOND)
        assertEquals(0, encoded(harness).size)
        harness.receive(CameraControl(CameraControl.START, 2f))
        film(harness, 10 * SECOND)
        assertEquals(20, encoded(harness).size)
        assertEquals(2f, encoded(harness).first().targetFpsHz)
        harness.receive(CameraControl(CameraControl.STOP, 0f))
        film(harness, 2 * SECOND)
        assertEquals(20, encoded(harness).size)
        assertEquals(listOf(AircraftCommand.SetVideo(true), AircraftCommand.SetVideo(false)), harness.commands)
        assertEquals(List(2) { Acknowledgment(1, 254) }, harness.acknowledgments)
    }

    @Test
    fun `the rate is limited, and a feed that does not start is off`() {
        val harness = Harness().connect()
        harness.receive(CameraControl(CameraControl.START, 1_000f))
        film(harness, 1 * SECOND)
        assertEquals(10, encoded(harness).size)
        harness.answers = Answer.Refused("camera busy")
        harness.receive(CameraControl(CameraControl.START, 5f))
        film(harness, 1 * SECOND)
        assertEquals(10, encoded(harness).size)
        assertEquals("Camera feed refused by the aircraft: camera busy", harness.messages.last())
    }

    @Test
    fun `a link that carries less gets fewer images, then poorer ones, and all again when it can`() {
        val pacer = VideoPacer(SessionSettings()).apply { start(5f, 0) }
        val slow = seen(pacer, bytesPerSecond = 40_000.0, seconds = 120)
        assertTrue(slow.last().bytes * slow.rate() in 15_000.0..40_000.0, "${slow.rate()}")
        assertTrue(pacer.quality == 85 && slow.rate() < 0.5)
        val slower = seen(pacer, bytesPerSecond = 8_000.0, seconds = 120)
        assertTrue(pacer.quality < 85 && slower.rate() >= 0.19, "${slower.rate()}")
        val fast = seen(pacer, bytesPerSecond = 10_000_000.0, seconds = 120)
        assertEquals(85, pacer.quality)
        assertEquals(5.0, fast.rate(), 0.2)
    }

    private class Written(val atNs: Long, val bytes: Int)

    /** Images a second over the last half. */
    private fun List<Written>.rate(): Double = drop(size / 2).let { (it.size - 1) * 1e9 / (it.last().atNs - it.first().atNs) }

    private var nowNs = 0L

    /** The images that a link takes one after the other: 85 kB at full quality. */
    private fun seen(pacer: VideoPacer, bytesPerSecond: Double, seconds: Int): List<Written> {
        val all = mutableListOf<Written>()
        val endNs = nowNs + seconds * SECOND
        while (nowNs < endNs) {
            nowNs += 33 * MS
            if (!pacer.takes(nowNs)) continue
            val bytes = 1_000 * pacer.quality
            val tookNs = (bytes / bytesPerSecond * SECOND).toLong()
            all += Written(nowNs, bytes)
            nowNs += tookNs
            pacer.written(tookNs)
        }
        return all
    }

    @Test
    fun `a lost link stops the feed`() {
        val harness = Harness().connect()
        harness.receive(CameraControl(CameraControl.START, 5f))
        harness.closeLink()
        assertEquals(AircraftCommand.SetVideo(false), harness.commands.last())
        film(harness, 1 * SECOND)
        assertEquals(0, encoded(harness).size)
        harness.closeLink()
        assertEquals(2, harness.commands.size)
        harness.session.imageEncoded(CompressedImage(5f, Bytes.of("late")))
        harness.session.linkOpened(harness.nowNs)
        harness.session.imageEncoded(CompressedImage(5f, Bytes.of("late")))
        harness.settle()
        assertEquals(emptyList(), harness.packets<CompressedImage>())
    }

    @Test
    fun `to a station that reads slowly the newest images go, and acknowledgments before them`() {
        val harness = Harness(isReading = false).connect()
        harness.receive(CameraControl(CameraControl.START, 5f))
        for (number in 1..5) harness.session.imageEncoded(CompressedImage(5f, Bytes.of("image $number")))
        val waiting = mutableListOf<Any>()
        repeat(20) {
            harness.session.packetSent(harness.nowNs)
            waiting += decode(harness.session.nextToSend(harness.nowNs) ?: return@repeat)
        }
        assertEquals(listOf("image 4", "image 5"), waiting.filterIsInstance<CompressedImage>().map {
            it.jpeg.toByteArray().decodeToString()
        })
        assertEquals(3L, harness.session.dropped.first)
        assertTrue(waiting.indexOfFirst { it is Acknowledgment } < waiting.indexOfFirst { it is CompressedImage })
    }

    @Test
    fun `a station that stops reading loses its link after five seconds, with a sentence`() {
        val harness = Harness(isReading = false).connect()
        harness.pass(4_900 * MS)
        assertEquals(emptyList(), harness.outputs.filterIsInstance<Output.CloseLink>())
        harness.pass(200 * MS)
        val close = harness.outputs.filterIsInstance<Output.CloseLink>().first()
        assertEquals("the station has not read for 5 s", close.reason)
        assertTrue(harness.session.dropped.second > 40)
    }

    @Test
    fun `answers and messages that wait are bounded, the oldest give way`() {
        val outbox = Outbox()
        repeat(100) { outbox.addAcknowledgment(byteArrayOf(it.toByte())) }
        assertContentEquals(byteArrayOf(36), outbox.poll())
        outbox.clear()
        assertNull(outbox.poll())
    }

    @Test
    fun `released control ends what the station started, and only stops pass`() {
        val harness = Harness().connect()
        harness.receive(STICK.copy(timeoutS = 30f))
        assertTrue(harness.session.hasStick && !harness.session.hasMission)
        harness.session.releaseControl(harness.nowNs)
        assertFalse(harness.session.hasStick)
        harness.settle()
        assertEquals(AircraftCommand.Hover, harness.commands.last())
        assertTrue(harness.session.isReleased)
        harness.executed.clear()
        harness.receive(mission(), STICK, RETURN, LAND, HOVER)
        assertEquals(listOf<AircraftCommand>(AircraftCommand.Hover), harness.commands)
        assertEquals(listOf(0, 0, 0, 0, 1), harness.acknowledgments.drop(1).map { it.positive })
        assertTrue("Control released to the pilot: only stops are accepted" in harness.messages)
        harness.closeLink()
        harness.session.linkOpened(harness.nowNs)
        harness.settle()
        assertTrue(harness.messages.last().endsWith("control released to the pilot"))
        harness.session.allowControl(harness.nowNs)
        harness.receive(LAND)
        assertEquals(AircraftCommand.Land, harness.commands.last())
        assertFalse(harness.session.isReleased)
    }

    @Test
    fun `releasing an aircraft that does nothing for the station sends it nothing`() {
        val harness = Harness().connect()
        harness.state = hovering(mode = FlightMode.SPORT)
        harness.session.releaseControl(harness.nowNs)
        harness.settle()
        assertEquals(emptyList(), harness.commands)
    }

    @Test
    fun `due times are always ahead, so that the app can sleep until then`() {
        val harness = Harness().connect()
        harness.receive(STICK, CameraControl(CameraControl.START, 5f))
        repeat(1_000) {
            harness.pass(10 * MS)
            assertTrue(harness.session.dueNs > harness.nowNs)
        }
        assertTrue(harness.session.isLinkOpen)
        harness.closeLink()
        assertEquals(Long.MAX_VALUE, harness.session.dueNs)
    }

    private fun encoded(harness: Harness) = harness.outputs.filterIsInstance<Output.Encode>()

    private fun film(harness: Harness, ns: Long) {
        repeat((ns / (33 * MS)).toInt()) {
            harness.pass(33 * MS)
            harness.session.frameTaken(frame, harness.nowNs)
            harness.settle()
        }
    }
}
