package recon.app.dji

import recon.aircraft.Aircraft
import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.VideoFrame
import recon.geo.LatLon
import recon.session.Severity
import recon.sim.SimulatedAircraft
import recon.sim.SimulatedSettings
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertNotNull
import kotlin.test.assertNull

class DjiSourceTest {
    private val registrations = mutableListOf<RegistrationListener>()
    private val reports = mutableListOf<Pair<Severity, String>>()
    private val answers = mutableListOf<Answer>()
    private val real = Recorded()
    private val source = DjiSource({ registrations += it }, { real })

    @Test
    fun `until it is registered there is no aircraft, and orders are refused`() {
        val aircraft = open()
        assertNull(aircraft.state())
        aircraft.execute(AircraftCommand.Hover) { answers += it }
        assertEquals(listOf<Answer>(Answer.Refused("DJI's SDK is not registered yet")), answers)
        registrations.single().registered()
        assertNotNull(aircraft.state())
        aircraft.execute(AircraftCommand.Hover) { answers += it }
        assertEquals(Answer.Accepted, answers.last())
    }

    @Test
    fun `frames asked for before the registration come after it`() {
        val listener: (VideoFrame) -> Unit = {}
        open().onFrame(listener)
        registrations.single().registered()
        assertEquals(listener, real.listener)
        open().onFrame(null)
        assertNull(real.listener)
    }

    @Test
    fun `it registers once, and again after a failure`() {
        repeat(2) { open() }
        registrations.single().failed("network (REQUEST_TIMEOUT)")
        val (severity, text) = reports.last()
        assertEquals(Severity.ERROR, severity)
        assertEquals("DJI's SDK is not registered: network (REQUEST_TIMEOUT)", text.substringBefore(';'))
        repeat(2) { open() }
        assertEquals(2, registrations.size)
    }

    private fun open(): Aircraft = source.open { severity, text -> reports += severity to text }

    private class Recorded : Aircraft {
        private val simulated =
            SimulatedAircraft(SimulatedSettings("SIM-1", LatLon(45.0, -93.0), 280.0, startHeightM = 20.0))
        var listener: ((VideoFrame) -> Unit)? = null

        override fun state(): AircraftState? = simulated.state()

        override fun execute(command: AircraftCommand, answered: (Answer) -> Unit) =
            simulated.execute(command, answered)

        override fun onFrame(listener: ((VideoFrame) -> Unit)?) {
            this.listener = listener
        }
    }
}
