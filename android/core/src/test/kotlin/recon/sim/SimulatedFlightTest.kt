package recon.sim

import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.BatteryWarning
import recon.aircraft.CameraState
import recon.aircraft.Capabilities
import recon.aircraft.FlightMode
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import recon.aircraft.StickSetpoint
import recon.geo.LatLon
import recon.geo.LocalPlane
import kotlin.math.abs
import kotlin.math.hypot
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertIs
import kotlin.test.assertTrue

private const val SECOND_NS = 1_000_000_000L
private val HOME = LatLon(45.0, -93.0)

class SimulatedFlightTest {
    private val settings = SimulatedSettings("SIM-1", HOME, takeoffAltitudeM = 280.0)
    private var nowNs = 0L
    private val plane = LocalPlane(HOME)

    @Test
    fun `it takes off, hovers, and lands when the landing is confirmed`() {
        val flight = SimulatedFlight(settings, 0)
        assertEquals(Answer.Refused("the motors are off"), flight.execute(AircraftCommand.Hover))
        flight.execute(AircraftCommand.TakeOff)
        assertTrue(!state(flight, 0.5).isFlying)
        assertEquals(FlightMode.AUTO_TAKEOFF, state(flight, 1.0).flightMode)
        assertEquals(1.2, state(flight, 6.0).heightAboveTakeoffM, 0.2)
        assertEquals(FlightMode.GPS_ATTI, state(flight, 0.1).flightMode)
        assertIs<Answer.Refused>(flight.execute(AircraftCommand.TakeOff))
        assertIs<Answer.Refused>(flight.execute(AircraftCommand.ConfirmLanding))
        flight.execute(AircraftCommand.Land)
        assertEquals(FlightMode.AUTO_LANDING, state(flight, 0.1).flightMode)
        val waiting = state(flight, 20.0)
        assertEquals(FlightMode.CONFIRM_LANDING, waiting.flightMode)
        assertTrue(waiting.needsLandingConfirmation && waiting.isFlying)
        assertEquals(0.3, waiting.heightAboveTakeoffM, 0.2)
        flight.execute(AircraftCommand.Land)
        assertEquals(Answer.Accepted, flight.execute(AircraftCommand.ConfirmLanding))
        assertTrue(state(flight, 3.0).isOnGround)
    }

    @Test
    fun `a takeoff stopped on the ground stops its motors`() {
        val flight = SimulatedFlight(settings, 0)
        flight.execute(AircraftCommand.TakeOff)
        state(flight, 0.5)
        assertEquals(Answer.Accepted, flight.execute(AircraftCommand.Hover))
        assertTrue(state(flight, 10.0).isOnGround)
    }

    @Test
    fun `sticks move it north or forward, and it stops when they stop coming`() {
        val flight = airborne(20.0)
        fly(flight, StickSetpoint(false, 90.0, 5.0, 0.0, 25.0), 6.0)
        val moving = state(flight, 0.0)
        assertEquals(5.0, moving.velocity.northMps, 0.1)
        assertEquals(90.0, moving.attitude.yawDeg, 0.1)
        assertEquals(FlightMode.JOYSTICK, moving.flightMode)
        fly(flight, StickSetpoint(true, 90.0, 4.0, 3.0, 25.0), 6.0)
        val body = state(flight, 0.0).velocity
        assertEquals(4.0, body.eastMps, 0.1)
        assertEquals(-3.0, body.northMps, 0.1)
        val still = state(flight, 5.0)
        assertEquals(0.0, hypot(still.velocity.northMps, still.velocity.eastMps), 0.01)
        assertEquals(25.0, still.heightAboveTakeoffM, 0.3)
    }

    @Test
    fun `a mission stops at its waypoints, loiters, and hovers at its end`() {
        val flight = airborne(20.0)
        val plan = plan(PlanSpot(0.0, 50.0, 30.0, loiterS = 5.0), PlanSpot(60.0, 50.0, 30.0))
        assertEquals(Answer.Accepted, flight.execute(AircraftCommand.FlyMission(plan)))
        val slowest = generateSequence { state(flight, 0.1) }.takeWhile { it.flightMode == FlightMode.WAYPOINT }
            .filter { distanceM(it, 0.0, 50.0) < 1.0 }.minOf { hypot(it.velocity.northMps, it.velocity.eastMps) }
        assertTrue(slowest < 0.05)
        val end = state(flight, 1.0)
        assertEquals(FlightMode.GPS_ATTI, end.flightMode)
        assertTrue(distanceM(end, 60.0, 50.0) < 1.0)
        assertEquals(30.0, end.heightAboveTakeoffM, 0.5)
    }

    @Test
    fun `a curved mission does not stop at its corner, and lands from the ground to the ground`() {
        val flight = SimulatedFlight(settings, 0)
        val spots = arrayOf(PlanSpot(0.0, 0.0, 20.0), PlanSpot(80.0, 0.0, 20.0), PlanSpot(80.0, 80.0, 20.0))
        flight.execute(AircraftCommand.FlyMission(plan(*spots).copy(isCurved = true, landsAtEnd = true)))
        val flown = generateSequence { state(flight, 0.1) }
            .takeWhile { it.isOnGround.not() && it.flightMode != FlightMode.CONFIRM_LANDING }.toList()
        val nearCorner = flown.filter { distanceM(it, 80.0, 0.0) < 12.0 }
        assertTrue(nearCorner.minOf { hypot(it.velocity.northMps, it.velocity.eastMps) } > 1.0)
        assertTrue(distanceM(flown.last(), 80.0, 80.0) < 2.0)
    }

    @Test
    fun `a mission beyond its own limits is accepted and not flown`() {
        val low = SimulatedFlight(settings.copy(maxHeightM = 25.0, maxDistanceM = 100.0, startHeightM = 10.0), 0)
        for (spot in listOf(PlanSpot(0.0, 50.0, 30.0), PlanSpot(0.0, 150.0, 20.0))) {
            assertEquals(Answer.Accepted, low.execute(AircraftCommand.FlyMission(plan(PlanSpot(0.0, 0.0, 20.0), spot))))
            assertEquals(FlightMode.GPS_ATTI, state(low, 1.0).flightMode)
        }
    }

    @Test
    fun `it reports its limits when it reaches them`() {
        val low = SimulatedFlight(settings.copy(maxHeightM = 25.0, maxDistanceM = 60.0, startHeightM = 10.0), 0)
        fly(low, StickSetpoint(false, 0.0, 10.0, 0.0, 100.0), 20.0)
        val state = state(low, 0.0)
        assertTrue(state.isAtMaxHeight && state.isAtMaxDistance)
        assertEquals(25.0, state.heightAboveTakeoffM, 0.5)
    }

    @Test
    fun `it climbs to the go-home height, flies to where it took off, and lands there`() {
        val flight = airborne(20.0)
        fly(flight, StickSetpoint(false, 0.0, 10.0, 0.0, 20.0), 10.0)
        flight.execute(AircraftCommand.GoHome)
        val flown = generateSequence { state(flight, 0.2) }.takeWhile { it.flightMode == FlightMode.GO_HOME }.toList()
        assertEquals(40.0, flown.maxOf { it.heightAboveTakeoffM }, 1.0)
        assertTrue(distanceM(state(flight, 1.0), 0.0, 0.0) < 1.0)
    }

    @Test
    fun `above home the return lasts long enough to be seen`() {
        val flight = airborne(45.0)
        flight.execute(AircraftCommand.GoHome)
        assertEquals(FlightMode.GO_HOME, state(flight, 1.9).flightMode)
        assertEquals(FlightMode.AUTO_LANDING, state(flight, 0.5).flightMode)
    }

    @Test
    fun `the pilot's mode switch takes it from the app, and gives it back`() {
        val flight = airborne(20.0)
        flight.pilotTakes()
        assertEquals(FlightMode.SPORT, state(flight, 0.1).flightMode)
        val refusal = Answer.Refused("the controller is not in normal mode")
        assertEquals(refusal, flight.execute(AircraftCommand.FlyMission(plan(PlanSpot(0.0, 9.0, 9.0)))))
        assertEquals(refusal, flight.execute(AircraftCommand.SetStick(StickSetpoint(false, 0.0, 1.0, 0.0, 9.0))))
        flight.pilotReleases()
        assertEquals(FlightMode.GPS_ATTI, state(flight, 0.1).flightMode)
        val onGround = SimulatedFlight(settings, 0)
        onGround.pilotTakes()
        onGround.pilotReleases()
        assertTrue(onGround.state().isOnGround)
    }

    @Test
    fun `an empty battery warns, then lands it`() {
        val flight = SimulatedFlight(settings.copy(enduranceMin = 1.0, startHeightM = 20.0), 0)
        assertEquals(BatteryWarning.NONE, state(flight, 30.0).batteryWarning)
        assertEquals(BatteryWarning.LOW, state(flight, 14.0).batteryWarning)
        assertEquals(BatteryWarning.SERIOUS, state(flight, 9.0).batteryWarning)
        assertEquals(FlightMode.AUTO_LANDING, state(flight, 5.0).flightMode)
    }

    @Test
    fun `camera state follows its feed and its capability`() {
        val flight = SimulatedFlight(settings, 0)
        assertEquals(CameraState.FEED_OFF, flight.state().cameraState)
        flight.execute(AircraftCommand.SetVideo(true))
        assertEquals(CameraState.FEED_ON, flight.state().cameraState)
        val without = SimulatedFlight(settings.copy(capabilities = Capabilities()), 0)
        assertEquals(CameraState.NOT_CONNECTED, without.state().cameraState)
    }

    @Test
    fun `angles wrap and speeds near a target settle`() {
        assertEquals(listOf(-170.0, 170.0, -180.0), listOf(190.0, -190.0, 180.0).map(::wrappedDeg))
        assertEquals(1.0, brakingSpeedMps(1.0, 2.0))
        assertEquals(2.0 * kotlin.math.sqrt(19.0), brakingSpeedMps(20.0, 2.0), 1e-9)
        assertTrue(abs(Motion(heightM = 10.0).towardsHeightMps(0.0, AirframeLimits())) <= 3.0)
    }

    private fun airborne(heightM: Double) = SimulatedFlight(settings.copy(startHeightM = heightM), nowNs)

    private fun state(flight: SimulatedFlight, afterS: Double): AircraftState {
        nowNs += (afterS * SECOND_NS).toLong()
        flight.advance(nowNs)
        return flight.state()
    }

    private fun fly(flight: SimulatedFlight, setpoint: StickSetpoint, seconds: Double) {
        repeat((10 * seconds).toInt()) {
            flight.execute(AircraftCommand.SetStick(setpoint))
            state(flight, 0.1)
        }
    }

    private class PlanSpot(val northM: Double, val eastM: Double, val heightM: Double, val loiterS: Double? = null)

    private fun plan(vararg spots: PlanSpot) = MissionPlan(
        spots.map { PlanPoint(plane.position(it.northM, it.eastM), it.heightM, 5.0, 8.0, it.loiterS) },
        isCurved = false,
        landsAtEnd = false,
    )

    private fun distanceM(state: AircraftState, northM: Double, eastM: Double): Double {
        val position = state.position!!
        return hypot(plane.northM(position) - northM, plane.eastM(position) - eastM)
    }
}
