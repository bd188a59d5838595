package recon.session

import recon.aircraft.FlightMode
import recon.wire.Bytes
import recon.wire.CoreTelemetry
import recon.wire.ExtendedTelemetry
import recon.wire.MessageString
import recon.wire.Packet
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertIs
import kotlin.test.assertTrue

class TelemetryTest {
    private val harness = Harness()

    @Test
    fun `a link begins with the identity, then reports the settings`() {
        harness.session.aircraftState(hovering(), 0)
        harness.session.linkOpened(0)
        harness.settle()
        val identity = assertIs<ExtendedTelemetry>(harness.sent.first().second)
        assertEquals(Bytes.of("1581F5BKD22BJ00A"), identity.serial)
        assertIs<CoreTelemetry>(harness.sent[1].second)
        val introduction = "Recon companion: waypoint altitude takeoff, mission on lost link hold, " +
            "hover on the ground ignore"
        assertEquals(listOf(introduction), harness.messages)
    }

    @Test
    fun `a simulated aircraft is announced first`() {
        harness.session.aircraftState(hovering().copy(isSimulated = true), 0)
        harness.session.linkOpened(0)
        harness.settle()
        assertEquals("recon-sim simulated vehicle", harness.messages.first())
    }

    @Test
    fun `core telemetry comes at 10 Hz and extended at 2 Hz`() {
        harness.connect()
        harness.pass(60 * SECOND)
        assertEquals(600, harness.packets<CoreTelemetry>().size)
        assertEquals(120, harness.packets<ExtendedTelemetry>().size)
        assertEquals(100 * MS, gaps<CoreTelemetry>().toSet().single())
    }

    @Test
    fun `a pause of the app is not caught up in a burst`() {
        harness.connect()
        harness.session.aircraftState(hovering(5 * SECOND), 5 * SECOND + 30 * MS)
        harness.settle()
        assertEquals(1, harness.packets<CoreTelemetry>().size)
    }

    @Test
    fun `a touchdown is reported before the mode that follows it`() {
        harness.connect()
        harness.pass(470 * MS)
        harness.sent.clear()
        harness.state = standing()
        harness.pass(40 * MS)
        assertEquals(listOf(0, 1), harness.sent.map { it.second.pid })
    }

    @Test
    fun `without an aircraft the link stays unidentified, and the identity follows at once`() {
        harness.state = null
        harness.connect()
        harness.pass(1 * SECOND)
        assertEquals(setOf(Bytes.EMPTY), harness.packets<ExtendedTelemetry>().map { it.serial }.toSet())
        assertEquals(emptyList(), harness.packets<CoreTelemetry>())
        harness.sent.clear()
        harness.state = hovering()
        harness.pass(10 * MS)
        assertEquals(Bytes.of("1581F5BKD22BJ00A"), harness.packets<ExtendedTelemetry>().single().serial)
    }

    @Test
    fun `stale state is not sent, and its loss is reported once`() {
        harness.connect()
        harness.passInSilence(6 * SECOND)
        assertTrue(harness.sent.filter { it.second !is MessageString }.all { it.first <= 2 * SECOND + 10 * MS })
        assertEquals(listOf("Telemetry of the aircraft lost: check its controller"), harness.messages)
        harness.sent.clear()
        harness.pass(200 * MS)
        assertEquals(2, harness.packets<CoreTelemetry>().size)
    }

    @Test
    fun `values are converted as the document asks`() {
        val core = coreTelemetryOf(hovering().copy(position = null))
        assertEquals(0.0 to 0.0, core.latitudeDeg to core.longitudeDeg)
        assertEquals(300.0, core.altitudeM)
        assertTrue(coreTelemetryOf(hovering().copy(takeoffAltitudeM = null)).altitudeM.isNaN())
        val wild = hovering().copy(
            gnssSatelliteCount = 70_000,
            gnssSignalLevel = 99,
            batteryPercent = 130,
            windLevel = 1_000,
            serial = "S".repeat(300),
            isAtMaxHeight = true,
            flightMode = FlightMode.OTHER,
        )
        val extended = extendedTelemetryOf(wild, 7)
        assertEquals(ExtendedTelemetry(65_535, 10, 1, 0, 100, 0, 127, 1, 255, 7, Bytes.of("S".repeat(256))), extended)
        val unknown = extendedTelemetryOf(hovering().copy(serial = null), 0)
        assertEquals(listOf(-1, 255, -1), listOf(unknown.gnssSignalLevel, unknown.batteryPercent, unknown.windLevel))
        assertEquals(Bytes.EMPTY, unknown.serial)
    }

    private inline fun <reified T : Packet> gaps(): List<Long> =
        harness.sent.filter { it.second is T }.map { it.first }.zipWithNext { a, b -> b - a }
}
