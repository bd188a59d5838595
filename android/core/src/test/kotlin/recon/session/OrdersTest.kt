package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftFacts
import recon.aircraft.AltitudeReference
import recon.aircraft.Answer
import recon.aircraft.Capabilities
import recon.aircraft.Capability
import recon.aircraft.FlightMode
import recon.geo.LatLon
import recon.wire.Acknowledgment
import recon.wire.Bytes
import recon.wire.CameraControl
import recon.wire.EmergencyCommand
import recon.wire.ExecuteWaypointMission
import recon.wire.MessageString
import recon.wire.Packet
import recon.wire.VirtualStickCommand
import recon.wire.Waypoint
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertIs
import kotlin.test.assertTrue

val HOVER = EmergencyCommand(EmergencyCommand.HOVER)
val LAND = EmergencyCommand(EmergencyCommand.LAND)
val RETURN = EmergencyCommand(EmergencyCommand.RETURN_HOME)

fun waypoint(northDeg: Double, altitudeM: Double = 30.0) =
    Waypoint(45.0 + northDeg, -93.0, altitudeM, 0.2f, 5f, Float.NaN, Float.NaN)

fun mission(vararg waypoints: Waypoint = arrayOf(waypoint(0.0), waypoint(0.001)), landsAtEnd: Boolean = false) =
    ExecuteWaypointMission(if (landsAtEnd) 1 else 0, 0, waypoints.toList())

class OrdersTest {
    private val harness = Harness().connect()

    @Test
    fun `an order is acknowledged when the aircraft has accepted it, not before`() {
        harness.answers = null
        harness.receive(HOVER)
        assertEquals(listOf<AircraftCommand>(AircraftCommand.Hover), harness.commands)
        harness.pass(300 * MS)
        assertEquals(emptyList(), harness.acknowledgments)
        harness.answer(harness.executed.single(), Answer.Accepted)
        assertEquals(listOf(Acknowledgment(1, 255)), harness.acknowledgments)
    }

    @Test
    fun `an order that the aircraft refuses is refused, with its reason made safe to show`() {
        harness.answers = Answer.Refused("compass\u001b[31m error")
        harness.receive(RETURN)
        assertEquals(listOf(Acknowledgment(0, 255)), harness.acknowledgments)
        assertEquals(listOf("Return refused by the aircraft: compass\uFFFD[31m error"), harness.messages)
    }

    @Test
    fun `each command reaches the aircraft`() {
        harness.receive(HOVER, LAND, RETURN, CameraControl(CameraControl.START, 2f), mission())
        val flown = harness.commands
        assertEquals(
            listOf(
                AircraftCommand.Hover, AircraftCommand.Land, AircraftCommand.GoHome, AircraftCommand.SetVideo(true),
            ),
            flown.dropLast(1),
        )
        assertEquals(2, assertIs<AircraftCommand.FlyMission>(flown.last()).plan.points.size)
        assertEquals(listOf(255, 255, 255, 254, 253), harness.acknowledgments.map { it.sourcePid })
        assertEquals("Mission of 2 waypoints", harness.session.lastOrder)
    }

    @Test
    fun `on the ground hover and return are refused with a sentence, and land has nothing to do`() {
        onGround()
        harness.receive(HOVER, RETURN, LAND)
        assertEquals(emptyList(), harness.commands)
        assertEquals(listOf(0, 0, 1), harness.acknowledgments.map { it.positive })
        assertEquals(
            listOf(
                "On the ground: hover is ignored; this app does not take off by hover (a setting)",
                "On the ground: return is ignored, there is nothing to return from",
            ),
            harness.messages,
        )
    }

    @Test
    fun `where the setting allows it a hover on the ground takes off`() {
        val allowing = Harness(SessionSettings(hoverOnGround = HoverOnGround.TAKEOFF)).apply { state = standing() }
        allowing.connect().receive(HOVER)
        assertEquals(listOf<AircraftCommand>(AircraftCommand.TakeOff), allowing.commands)
    }

    @Test
    fun `a stop during takeoff is a stop, although the aircraft is not yet in the air`() {
        harness.state = standing().copy(flightMode = FlightMode.AUTO_TAKEOFF)
        harness.pass(10 * MS)
        harness.receive(HOVER)
        assertEquals(listOf<AircraftCommand>(AircraftCommand.Hover), harness.commands)
    }

    @Test
    fun `without telemetry of the aircraft a stop and a landing are passed on, and nothing else`() {
        harness.state = null
        harness.pass(10 * MS)
        harness.receive(HOVER, LAND, RETURN, mission(), STICK, CameraControl(1, 2f))
        assertEquals(listOf(AircraftCommand.Hover, AircraftCommand.Land), harness.commands)
        assertEquals(listOf(1, 1, 0, 0, 0, 0), harness.acknowledgments.map { it.positive }.sortedDescending())
        assertTrue(harness.messages.single().startsWith("No telemetry from the aircraft"))
    }

    @Test
    fun `a mission far away, or beyond the aircraft's own limits, is refused with what to do`() {
        val near = mission().waypoints.first()
        for ((state, expected) in listOf(
            hovering().copy(position = LatLon(near.latitudeDeg + 0.144, near.longitudeDeg)) to
                "The first waypoint is 16.0 km from the aircraft, at most 10.0 km can be flown: is the station's site",
            hovering().copy(facts = AircraftFacts(maxHeightM = 20.0)) to
                "Waypoint 1 is 30 m above takeoff, and the aircraft's maximum height is set to 20 m: raise it",
            hovering().copy(facts = AircraftFacts(LatLon(45.0, -93.02), maxDistanceM = 500.0)) to
                "Waypoint 1 is 1.6 km from the home point, and the aircraft's maximum distance is set to 0.5 km:",
        )) {
            harness.state = state
            harness.pass(10 * MS)
            harness.receive(mission())
            assertTrue(harness.messages.last().startsWith(expected), harness.messages.last())
        }
        harness.state = hovering().copy(position = null, facts = AircraftFacts(maxDistanceM = 500.0, maxHeightM = 50.0))
        harness.pass(10 * MS)
        harness.receive(mission())
        assertEquals(1, harness.commands.size)
    }

    @Test
    fun `functions that the aircraft does not report are not used`() {
        harness.state = hovering().copy(
            capabilities = Capabilities(Capability.UNSUPPORTED, Capability.UNKNOWN, Capability.UNSUPPORTED),
        )
        harness.pass(10 * MS)
        harness.receive(mission(), STICK, CameraControl(1, 2f))
        assertEquals(emptyList(), harness.commands)
        assertEquals(
            listOf(
                "This aircraft has no waypoint missions",
                "Not known yet whether this aircraft has virtual stick; try again in a few seconds",
                "This aircraft has no camera feed",
            ),
            harness.messages,
        )
    }

    @Test
    fun `values outside the document are refused with what was expected`() {
        assertRefused("Emergency action must be 0, 1 or 2; got 3", EmergencyCommand(3))
        assertEquals("Emergency", harness.session.lastOrder)
        assertRefused("Camera action must be 0 to 3; got 9", CameraControl(9, 1f))
        assertRefused("Frame rate must be over 0 Hz; got NaN", CameraControl(1, Float.NaN))
        assertRefused("Frame rate must be over 0 Hz; got -1", CameraControl(1, -1f))
        assertRefused("Stick mode must be 0 or 1; got 2", STICK.copy(mode = 2))
        assertRefused("Stick timeout must be over 0 s; got NaN", STICK.copy(timeoutS = Float.NaN))
        assertRefused("Stick timeout must be 0 to 60 s; got 61", STICK.copy(timeoutS = 61f))
        val endless = STICK.copy(velocityXMps = Float.POSITIVE_INFINITY)
        assertRefused("Stick velocity X must be -15 to 15 m/s; got Infinity", endless)
        assertRefused("Stick velocity Y must be -15 to 15 m/s; got -15.50", STICK.copy(velocityYMps = -15.5f))
        assertRefused("Stick yaw must be -180 to 180 degrees; got 181", STICK.copy(yawDeg = 181f))
        assertRefused(
            "Stick height must be 0 to 500 m above takeoff; got -1", STICK.copy(heightAboveTakeoffM = -1f),
        )
        assertRefused("A mission has 2 to 99 waypoints; got 1", mission(waypoint(0.0)))
    }

    @Test
    fun `altitudes of the first revision lose the altitude of the takeoff point`() {
        val wgs84 = Harness(SessionSettings(altitudeReference = AltitudeReference.WGS84)).connect()
        wgs84.receive(mission(waypoint(0.0, 310.0), waypoint(0.001, 320.0)))
        val plan = assertIs<AircraftCommand.FlyMission>(wgs84.commands.single()).plan
        assertEquals(listOf(30.0, 40.0), plan.points.map { it.heightAboveTakeoffM })
        wgs84.state = hovering().copy(takeoffAltitudeM = null)
        wgs84.pass(10 * MS)
        wgs84.receive(mission())
        assertEquals("Waypoint altitudes are WGS84 here, and the takeoff altitude is unknown", wgs84.messages.last())
    }

    @Test
    fun `packets of the wrong side are ignored`() {
        harness.receive(Acknowledgment(1, 255), MessageString(1, Bytes.of("hello")))
        assertEquals(emptyList(), harness.commands)
        assertEquals(emptyList(), harness.acknowledgments)
    }

    @Test
    fun `a slow answer is announced, a missing one is a refusal`() {
        harness.answers = null
        harness.receive(LAND)
        harness.pass(1_600 * MS)
        assertEquals(listOf("Land: the aircraft has not answered yet"), harness.messages)
        harness.pass(20 * SECOND)
        assertEquals(listOf(Acknowledgment(0, 255)), harness.acknowledgments)
        assertEquals("Land refused by the aircraft: no answer", harness.messages.last())
        harness.answer(harness.executed.single(), Answer.Accepted)
        assertEquals(1, harness.acknowledgments.size)
    }

    @Test
    fun `an answer that comes on the next link is not acknowledged there`() {
        harness.answers = null
        harness.receive(LAND)
        harness.closeLink()
        harness.session.linkOpened(harness.nowNs)
        harness.answer(harness.executed.single(), Answer.Accepted)
        assertEquals(emptyList(), harness.acknowledgments)
    }

    @Test
    fun `orders without answers are limited, and a stop is not`() {
        harness.answers = null
        repeat(70) { harness.receive(RETURN) }
        assertEquals(64, harness.commands.size)
        assertEquals(6, harness.acknowledgments.size)
        harness.receive(HOVER)
        assertEquals(AircraftCommand.Hover, harness.commands.last())
    }

    @Test
    fun `the same sentence is not repeated to the station within five seconds`() {
        onGround()
        repeat(10) { harness.receive(HOVER) }
        assertEquals(1, harness.messages.size)
        harness.pass(5 * SECOND)
        harness.receive(HOVER)
        assertEquals(2, harness.messages.size)
    }

    private fun onGround() {
        harness.state = standing()
        harness.pass(10 * MS)
        harness.sent.clear()
    }

    private fun assertRefused(reason: String, packet: Packet) {
        harness.receive(packet)
        assertEquals(reason, harness.messages.last())
        assertEquals(Acknowledgment(0, packet.pid), harness.acknowledgments.last())
        assertEquals(emptyList(), harness.commands)
    }

    companion object {
        val STICK = VirtualStickCommand(0, 90f, 5f, -2f, 30f, 0.5f)
    }
}
