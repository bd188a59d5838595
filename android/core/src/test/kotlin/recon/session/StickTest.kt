package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.Answer
import recon.aircraft.FlightMode
import recon.aircraft.StickSetpoint
import recon.session.OrdersTest.Companion.STICK
import recon.wire.Acknowledgment
import recon.wire.Bytes
import recon.wire.CompressedImage
import recon.wire.encode
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertIs
import kotlin.test.assertTrue

class StickTest {
    private val harness = Harness().connect()
    private val moving = StickSetpoint(false, 90.0, 5.0, -2.0, 30.0)

    @Test
    fun `a setpoint is flown at once and repeated ten times a second`() {
        harness.receive(STICK.copy(timeoutS = 3f))
        harness.pass(2_950 * MS)
        assertEquals(List(30) { AircraftCommand.SetStick(moving) }, harness.commands)
        assertEquals(listOf(Acknowledgment(1, 252)), harness.acknowledgments)
    }

    @Test
    fun `after the timeout the same setpoint without velocity is flown, then a hover`() {
        harness.receive(STICK)
        harness.pass(490 * MS)
        assertEquals(moving, lastSetpoint())
        harness.pass(10 * MS)
        assertEquals(moving.stopped, lastSetpoint())
        harness.pass(2 * SECOND - 10 * MS)
        assertEquals(moving.stopped, lastSetpoint())
        harness.pass(10 * MS)
        assertEquals(AircraftCommand.Hover, harness.commands.last())
        assertEquals(listOf("No stick command before its timeout: stopped and hovering"), harness.messages)
        val count = harness.commands.size
        harness.pass(5 * SECOND)
        assertEquals(count, harness.commands.size)
    }

    @Test
    fun `a newer command restarts the timeout, also out of the neutral phase`() {
        repeat(10) {
            harness.receive(STICK)
            harness.pass(400 * MS)
        }
        assertTrue(harness.commands.all { it == AircraftCommand.SetStick(moving) })
        harness.pass(1 * SECOND)
        harness.receive(STICK.copy(velocityXMps = 1f))
        assertEquals(1.0, lastSetpoint().velocityXMps)
    }

    @Test
    fun `a lost link ends sticks at once with a hover`() {
        harness.receive(STICK.copy(timeoutS = 60f))
        harness.closeLink()
        assertEquals(AircraftCommand.Hover, harness.commands.last())
        harness.pass(1 * SECOND)
        assertEquals(AircraftCommand.Hover, harness.commands.last())
    }

    @Test
    fun `the pilot who leaves virtual stick keeps the aircraft`() {
        harness.receive(STICK.copy(timeoutS = 60f))
        harness.state = hovering(mode = FlightMode.JOYSTICK)
        harness.pass(1_100 * MS)
        assertEquals(12, harness.commands.size)
        harness.state = hovering(mode = FlightMode.SPORT)
        harness.pass(2 * SECOND)
        assertEquals(12, harness.commands.size)
        assertEquals(listOf("Virtual stick ended: the pilot has taken over"), harness.messages)
    }

    @Test
    fun `modes that linger from a hover just before are not taken for the pilot`() {
        harness.state = hovering(mode = FlightMode.JOYSTICK)
        harness.receive(STICK.copy(timeoutS = 60f))
        harness.pass(100 * MS)
        harness.state = hovering()
        harness.pass(500 * MS)
        harness.state = hovering(mode = FlightMode.JOYSTICK)
        harness.pass(2 * SECOND)
        assertTrue(harness.messages.isEmpty())
        assertEquals(27, harness.commands.size)
    }

    @Test
    fun `a command behind half a packet does not come out of a link that has ended`() {
        val header = byteArrayOf(0xDA.toByte(), 0xA7.toByte(), 0, 0, 40, 0, 9)
        harness.session.received(header + encode(STICK.copy(timeoutS = 60f)), harness.nowNs)
        harness.closeLink()
        harness.pass(5 * SECOND)
        assertEquals(emptyList(), harness.commands)
    }

    @Test
    fun `a refused setpoint is not repeated`() {
        harness.answers = Answer.Refused("the controller is not in normal mode")
        harness.receive(STICK)
        harness.pass(1 * SECOND)
        assertEquals(1, harness.commands.size)
        assertEquals("Stick refused by the aircraft: the controller is not in normal mode", harness.messages.single())
    }

    @Test
    fun `a command withheld behind damaged bytes beyond its timeout is not flown`() {
        val header = encode(CompressedImage(1f, Bytes.EMPTY)).copyOf(7)
        // Of a packet that an app accepts, so that the reader waits for the rest of it.
        val falseHeader = byteArrayOf(header[0], header[1], 0, 0, 40, 0, 9)
        harness.session.received(falseHeader + encode(STICK), harness.nowNs)
        harness.pass(2_100 * MS)
        assertEquals(emptyList(), harness.commands)
        assertEquals("Stick arrived after its own timeout", harness.messages.last())
    }

    @Test
    fun `body frame is kept, and other orders end the stream`() {
        harness.receive(STICK.copy(mode = 1, timeoutS = 5f))
        assertTrue(lastSetpoint().isBodyFrame)
        harness.receive(LAND)
        harness.pass(1 * SECOND)
        assertEquals(AircraftCommand.Land, harness.commands.last())
    }

    private fun lastSetpoint(): StickSetpoint =
        assertIs<AircraftCommand.SetStick>(harness.commands.last()).setpoint
}
