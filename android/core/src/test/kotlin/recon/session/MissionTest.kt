package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.Answer
import recon.aircraft.FlightMode
import recon.session.OrdersTest.Companion.STICK
import recon.wire.Acknowledgment
import recon.wire.ExtendedTelemetry
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertFalse
import kotlin.test.assertTrue

class MissionTest {
    private val harness = Harness().connect()

    @Test
    fun `a mission flown has its number in telemetry, and the next one the next number`() {
        flyMission()
        assertEquals(1, missionId())
        harness.state = hovering()
        harness.pass(6 * SECOND)
        assertEquals(0, missionId())
        flyMission()
        assertEquals(2, missionId())
    }

    @Test
    fun `while a mission is being uploaded another one is refused, and no order is held back`() {
        harness.answers = null
        harness.receive(mission(), mission())
        assertEquals(listOf(Acknowledgment(0, 253)), harness.acknowledgments)
        assertEquals("A mission is being uploaded: send the next one when it is answered", harness.messages.single())
        harness.receive(HOVER)
        assertEquals(AircraftCommand.Hover, harness.commands.last())
    }

    @Test
    fun `a mission that is never answered is given up with a hover, and ended if it is accepted later`() {
        harness.answers = null
        harness.receive(mission())
        harness.pass(21 * SECOND)
        assertEquals(listOf(Acknowledgment(0, 253)), harness.acknowledgments)
        assertEquals(AircraftCommand.Hover, harness.commands.last())
        val upload = harness.executed.first()
        repeat(2) { harness.answer(upload, Answer.Accepted) }
        assertTrue("Mission accepted after it was given up: it is ended" in harness.messages)
        assertEquals(3, harness.commands.size)
        assertEquals(AircraftCommand.Hover, harness.commands.last())
    }

    @Test
    fun `what the aircraft notes of a mission is told`() {
        harness.answers = Answer.Noted("DJI's check found no fault")
        harness.receive(mission())
        assertEquals("Mission: DJI's check found no fault", harness.messages.last())
        assertEquals(listOf(Acknowledgment(1, 253)), harness.acknowledgments)
    }

    @Test
    fun `a mission accepted after a newer order is undone by repeating that order`() {
        harness.answers = null
        harness.receive(mission(), RETURN)
        val (upload, goHome) = harness.executed
        harness.answer(goHome, Answer.Accepted)
        harness.answer(upload, Answer.Accepted)
        assertEquals(AircraftCommand.GoHome, harness.commands.last())
        assertEquals(3, harness.commands.size)
        assertEquals(listOf(Acknowledgment(1, 255), Acknowledgment(0, 253)), harness.acknowledgments)
    }

    @Test
    fun `a superseded mission that the aircraft refuses is refused`() {
        harness.answers = null
        harness.receive(mission(), STICK)
        harness.answer(harness.executed.first(), Answer.Refused("no GNSS"))
        assertEquals(listOf(Acknowledgment(0, 253)), harness.acknowledgments)
        assertEquals("Mission refused by the aircraft: no GNSS", harness.messages.last())
    }

    @Test
    fun `a mission that the aircraft accepts and does not fly is reported`() {
        harness.receive(mission())
        harness.pass(4_900 * MS)
        assertTrue(harness.messages.isEmpty())
        harness.pass(200 * MS)
        assertTrue(harness.messages.single().startsWith("The aircraft accepted the mission and did not start it"))
    }

    @Test
    fun `modes that change to and fro while one mission replaces another do not end it`() {
        flyMission()
        harness.receive(mission())
        harness.state = hovering()
        harness.pass(1 * SECOND)
        harness.state = hovering(mode = FlightMode.WAYPOINT)
        harness.pass(1 * SECOND)
        assertEquals(2, missionId())
    }

    @Test
    fun `a lost link acts on a mission as it is set`() {
        assertEquals(listOf<AircraftCommand>(), afterLostLink(LinkLossAction.CONTINUE))
        assertEquals(listOf<AircraftCommand>(AircraftCommand.Hover), afterLostLink(LinkLossAction.HOLD))
        assertEquals(listOf<AircraftCommand>(AircraftCommand.GoHome), afterLostLink(LinkLossAction.RETURN))
    }

    @Test
    fun `a link that is back within five seconds changes nothing`() {
        flyMission()
        harness.closeLink()
        harness.pass(4 * SECOND)
        harness.session.linkOpened(harness.nowNs)
        harness.pass(10 * SECOND)
        assertEquals(emptyList(), harness.commands)
    }

    @Test
    fun `a mission that ended before the link was lost causes nothing`() {
        flyMission()
        harness.receive(HOVER)
        harness.executed.clear()
        harness.state = hovering()
        harness.closeLink()
        harness.pass(10 * SECOND)
        assertEquals(emptyList(), harness.commands)
    }

    @Test
    fun `a mission accepted after the link was lost is under the same setting`() {
        harness.answers = null
        harness.receive(mission())
        harness.closeLink()
        harness.answers = Answer.Accepted
        harness.answer(harness.executed.single(), Answer.Accepted)
        harness.state = hovering(mode = FlightMode.WAYPOINT)
        harness.pass(6 * SECOND)
        assertEquals(AircraftCommand.Hover, harness.commands.last())
    }

    @Test
    fun `a landing that the station ordered is confirmed once a second until it goes on`() {
        harness.receive(LAND)
        harness.executed.clear()
        harness.state = hovering(mode = FlightMode.CONFIRM_LANDING).copy(needsLandingConfirmation = true)
        harness.pass(2_500 * MS)
        assertEquals(List(3) { AircraftCommand.ConfirmLanding }, harness.commands)
        harness.state = hovering(mode = FlightMode.AUTO_LANDING)
        harness.pass(2 * SECOND)
        assertEquals(3, harness.commands.size)
    }

    @Test
    fun `landings after a mission and a return are confirmed, the pilot's own is not`() {
        val waiting = hovering(mode = FlightMode.CONFIRM_LANDING).copy(needsLandingConfirmation = true)
        for ((order, isConfirmed) in listOf(mission(landsAtEnd = true) to true, RETURN to true, mission() to false)) {
            val each = Harness().connect()
            each.receive(order)
            each.state = waiting
            each.pass(100 * MS)
            assertEquals(isConfirmed, AircraftCommand.ConfirmLanding in each.commands, "$order")
        }
        harness.state = waiting
        harness.pass(1 * SECOND)
        assertFalse(AircraftCommand.ConfirmLanding in harness.commands)
    }

    @Test
    fun `released control ends a mission, flown or still being uploaded, with a hover`() {
        flyMission()
        harness.session.releaseControl(harness.nowNs)
        harness.settle()
        assertEquals(listOf<AircraftCommand>(AircraftCommand.Hover), harness.commands)
        val uploading = Harness().connect().apply { answers = null }
        uploading.receive(mission())
        uploading.session.releaseControl(uploading.nowNs)
        uploading.settle()
        uploading.answer(uploading.executed.first(), Answer.Accepted)
        assertEquals(listOf(AircraftCommand.Hover, AircraftCommand.Hover), uploading.commands.drop(1))
    }

    @Test
    fun `a hover of its own that the aircraft refuses is an error for the operator`() {
        flyMission()
        harness.answers = Answer.Refused("SDK not registered")
        harness.session.releaseControl(harness.nowNs)
        harness.settle()
        assertTrue("Hover for the pilot refused by the aircraft: SDK not registered" in harness.messages)
    }

    @Test
    fun `mission numbers stay within 16 bits and are never zero`() {
        val run = MissionRun(SessionSettings())
        val flown = hovering(mode = FlightMode.WAYPOINT)
        repeat(0xFFFF) { run.accepted(0) }
        assertEquals(0xFFFF, run.idFor(flown))
        run.accepted(0)
        assertEquals(1, run.idFor(flown))
        assertEquals(0, run.idFor(null))
    }

    private fun flyMission() {
        harness.state = hovering()
        harness.pass(10 * MS)
        harness.receive(mission())
        harness.state = hovering(mode = FlightMode.WAYPOINT)
        harness.pass(1 * SECOND)
        harness.executed.clear()
    }

    private fun missionId(): Int = harness.packets<ExtendedTelemetry>().last().missionId

    private fun afterLostLink(action: LinkLossAction): List<AircraftCommand> {
        val each = Harness(SessionSettings(missionOnLinkLoss = action)).connect()
        each.receive(mission())
        each.state = hovering(mode = FlightMode.WAYPOINT)
        each.pass(1 * SECOND)
        each.executed.clear()
        each.closeLink()
        each.pass(10 * SECOND)
        return each.commands
    }
}
