package recon.app

import recon.aircraft.AircraftState
import recon.aircraft.AltitudeReference
import recon.aircraft.Attitude
import recon.aircraft.BatteryWarning
import recon.aircraft.Capabilities
import recon.aircraft.Capability
import recon.aircraft.FlightMode
import recon.aircraft.VelocityNed
import recon.geo.LatLon
import recon.session.CompanionSession
import recon.session.HoverOnGround
import recon.session.LinkLossAction
import recon.session.SessionSettings
import recon.session.Severity
import recon.wire.EmergencyCommand
import recon.wire.VirtualStickCommand
import recon.wire.encode
import java.io.File
import java.time.Instant
import kotlin.io.path.createTempDirectory
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertFalse
import kotlin.test.assertNull
import kotlin.test.assertTrue

private const val SECOND_NS = 1_000_000_000L

private val FLYING = AircraftState(
    updatedNs = 0,
    serial = "1581F5BKD22BJ00A",
    isFlying = true,
    flightMode = FlightMode.GPS_ATTI,
    position = LatLon(45.0, -93.0),
    heightAboveTakeoffM = 23.6,
    takeoffAltitudeM = 280.0,
    velocity = VelocityNed(0.0, 0.0, 0.0),
    attitude = Attitude(90.0, 0.0, 0.0),
    batteryPercent = 81,
    capabilities = Capabilities(Capability.SUPPORTED, Capability.SUPPORTED, Capability.SUPPORTED),
)

class StatusTest {
    private val session = CompanionSession(SessionSettings())

    @Test
    fun `before anything has come, each row shows so`() {
        val status = statusOf(session, 0)
        assertEquals(Row("No station", Level.PROBLEM), status.link)
        assertEquals(Row("No aircraft", Level.PROBLEM), status.aircraft)
        assertEquals(Row("Pilot: no station"), status.control)
        assertEquals(Row("None yet"), status.lastOrder)
        assertEquals(Row("Above takeoff"), status.altitudeReference)
    }

    @Test
    fun `the aircraft is shown with its height and battery, and never a value that is old`() {
        assertEquals(Row("1581F5BKD22BJ00A: flying, 24 m, battery 81 %"), aircraft(FLYING))
        assertEquals(Row("1581F5BKD22BJ00A: telemetry lost", Level.PROBLEM), aircraft(FLYING, 2 * SECOND_NS + 1))
        val standing = FLYING.copy(isFlying = false, serial = null, batteryPercent = null)
        assertEquals(Row("Serial unknown: on the ground, battery unknown"), aircraft(standing))
        assertEquals(Level.CAUTION, aircraft(FLYING.copy(batteryWarning = BatteryWarning.LOW)).level)
        assertEquals(Level.PROBLEM, aircraft(FLYING.copy(batteryWarning = BatteryWarning.SERIOUS)).level)
    }

    @Test
    fun `who controls follows the session`() {
        session.aircraftState(FLYING, 0)
        session.linkOpened(0)
        assertEquals(Row("Station"), control())
        session.received(encode(VirtualStickCommand(0, 90f, 5f, 0f, 30f, 30f)), 0)
        assertEquals(Row("Station: virtual stick"), control())
        assertTrue(statusOf(session, 0).isFlyingForStation)
        assertEquals(Row("Stick"), statusOf(session, 0).lastOrder)
        session.releaseControl(0)
        assertEquals(Row("Pilot: released", Level.CAUTION), control())
        assertFalse(statusOf(session, 0).isFlyingForStation)
        session.received(encode(EmergencyCommand(EmergencyCommand.LAND)), 0)
        assertEquals(Row("Land"), statusOf(session, 0).lastOrder)
    }

    @Test
    fun `settings that are less usual or less safe are marked`() {
        val settings = SessionSettings(AltitudeReference.WGS84, LinkLossAction.CONTINUE, HoverOnGround.TAKEOFF)
        val status = statusOf(CompanionSession(settings), 0)
        assertEquals(Row("WGS84", Level.CAUTION), status.altitudeReference)
        assertEquals(Row("Continue", Level.CAUTION), status.missionOnLinkLoss)
        assertEquals(Row("Takes off", Level.CAUTION), status.hoverOnGround)
        assertNull(statusOf(session, 0).hoverOnGround)
        assertEquals(Row("Hold"), statusOf(session, 0).missionOnLinkLoss)
        val returning = CompanionSession(SessionSettings(missionOnLinkLoss = LinkLossAction.RETURN))
        assertEquals(Row("Return"), statusOf(returning, 0).missionOnLinkLoss)
    }

    private fun aircraft(state: AircraftState, nowNs: Long = 0): Row {
        session.aircraftState(state, 0)
        return statusOf(session, nowNs).aircraft
    }

    private fun control() = statusOf(session, 0).control
}

class SpokenWarningsTest {
    private val uttered = mutableListOf<Pair<String, Boolean>>()
    private val spoken = SpokenWarnings { text, isUrgent -> uttered += text to isUrgent }

    @Test
    fun `warnings are spoken and errors interrupt them, information is not`() {
        spoken.notice(Severity.INFO, "Connected to the station", 0)
        spoken.notice(Severity.WARNING, "Link to the station lost", 0)
        spoken.notice(Severity.ERROR, "Mission refused", 0)
        assertEquals(listOf("Link to the station lost" to false, "Mission refused" to true), uttered)
    }

    @Test
    fun `the same sentence is spoken once in ten seconds`() {
        for (second in 0L..20L) spoken.notice(Severity.WARNING, "No station", second * 1_000)
        assertEquals(3, uttered.size)
    }

    @Test
    fun `a flood of warnings is not spoken to its end`() {
        repeat(1_000) { spoken.notice(Severity.WARNING, "Refused: $it", 0) }
        assertEquals(5, uttered.size)
    }
}

class PhoneStateTest {
    private val phone = PhoneState()

    @Test
    fun `each step of the battery is reported once`() {
        val warnings = (100 downTo 0).mapNotNull { phone.battery(it, isCharging = false) }
        assertEquals(listOf(20, 10, 5), warnings.map { Regex("\\d+").find(it.text)!!.value.toInt() })
        assertEquals(listOf(Severity.WARNING, Severity.WARNING, Severity.ERROR), warnings.map { it.severity })
    }

    @Test
    fun `a charger ends the warnings, and they begin anew without it`() {
        assertTrue(phone.battery(9, isCharging = false) != null)
        assertNull(phone.battery(9, isCharging = true))
        assertTrue(phone.battery(9, isCharging = false) != null)
    }

    @Test
    fun `heat is reported as it rises`() {
        val warnings = listOf(0, 1, 2, 2, 3, 4, 0, 3).map { phone.thermal(it)?.severity }
        val expected = listOf(null, null, Severity.WARNING, null, Severity.ERROR, null, null, Severity.ERROR)
        assertEquals(expected, warnings)
    }
}

class FlightLogTest {
    private val folder: File = createTempDirectory("log").toFile()
    private var now = Instant.parse("2026-07-01T10:00:00.250Z")
    private val log = FlightLog(folder, Runnable::run) { now }

    @Test
    fun `a line is one line, with its time, whatever the network sent`() {
        log.add("info", "before the first file")
        log.begin()
        log.add("warning", "Refused\r\n2026-07-01T10:00:01Z start   forged")
        val lines = log.newest()!!.readLines()
        assertEquals(listOf("2026-07-01T10:00:00.250Z warning Refused  2026-07-01T10:00:01Z start   forged"), lines)
        assertEquals("recon-2026-07-01T100000Z.log", log.newest()!!.name)
    }

    @Test
    fun `ten files are kept, and none grows without an end`() {
        repeat(15) {
            now = now.plusSeconds(60)
            log.begin()
            log.add("start", "$it")
        }
        assertEquals(10, folder.list()!!.size)
        assertTrue(log.newest()!!.readText().endsWith("14\n"))
        repeat(50) { log.add("info", "x".repeat(100_000)) }
        assertTrue(log.newest()!!.length() <= 4_000_000)
    }
}
