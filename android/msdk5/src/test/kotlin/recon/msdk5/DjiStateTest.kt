package recon.msdk5

import dji.sdk.keyvalue.value.flightcontroller.FCFlightMode
import recon.aircraft.AircraftState
import recon.aircraft.BatteryWarning
import recon.aircraft.CameraState
import recon.aircraft.Capability
import recon.aircraft.Failsafe
import recon.aircraft.FlightMode
import recon.aircraft.VelocityNed
import recon.aircraft.altitudeM
import recon.geo.LatLon
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertNull
import kotlin.test.assertTrue

class DjiStateTest {

    @Test
    fun `DJI's values become a state, heights relative to takeoff as they come`() {
        val state = aircraftState(FLYING, isVideoOn = true)!!
        assertEquals(LatLon(45.0, -93.0), state.position)
        assertEquals(20.0, state.heightAboveTakeoffM)
        assertEquals(300.0, state.altitudeM())
        assertEquals(VelocityNed(1.0, 2.0, -0.5), state.velocity)
        assertEquals(listOf(5, 1), listOf(state.gnssSignalLevel, state.windLevel))
        assertEquals(CameraState.FEED_ON, state.cameraState)
        assertEquals(40.0 to Failsafe.GO_HOME, state.capabilities.run { goHomeHeightM to failsafe })
    }

    @Test
    fun `what DJI has not reported is unknown, and no state exists before its flight controller reports`() {
        assertNull(aircraftState(DjiSnapshot(updatedNs = 1), isVideoOn = false))
        val state = aircraftState(DjiSnapshot(updatedNs = 1, isFlying = false), isVideoOn = false)!!
        assertNull(state.position)
        assertNull(state.serial)
        val values = listOf(state.heightAboveTakeoffM, state.velocity.northMps, state.attitude.yawDeg)
        assertTrue(values.all { it.isNaN() })
        assertEquals(FlightMode.OTHER, state.flightMode)
        assertEquals(List(3) { Capability.UNKNOWN }, functions(state))
    }

    @Test
    fun `a receiver without a fix has no position`() {
        assertNull(aircraftState(FLYING.copy(latitudeDeg = 0.0, longitudeDeg = 0.0), false)!!.position)
        assertNull(aircraftState(FLYING.copy(latitudeDeg = Double.NaN), false)!!.position)
        assertNull(aircraftState(FLYING.copy(longitudeDeg = null), false)!!.position)
        assertNull(aircraftState(FLYING.copy(takeoffAltitudeM = Double.NaN), false)!!.takeoffAltitudeM)
    }

    @Test
    fun `functions are those that the aircraft reports`() {
        val mini3 = FLYING.copy(missionState = "NOT_SUPPORTED", isVirtualStickSupported = false, hasCamera = false)
        val state = aircraftState(mini3, isVideoOn = true)!!
        assertEquals(List(3) { Capability.UNSUPPORTED }, functions(state))
        assertEquals(CameraState.NOT_CONNECTED, state.cameraState)
        assertEquals(CameraState.FEED_OFF, aircraftState(FLYING, isVideoOn = false)!!.cameraState)
    }

    @Test
    fun `battery warnings and failsafe keep their order`() {
        assertEquals(BatteryWarning.SERIOUS, warning(isLow = true, isSerious = true))
        assertEquals(BatteryWarning.LOW, warning(isLow = true, isSerious = false))
        assertEquals(Failsafe.HOVER, failsafe("HOVER"))
        assertEquals(Failsafe.LAND, failsafe("LANDING"))
        assertEquals(Failsafe.UNKNOWN, failsafe(null))
    }

    @Test
    fun `every flight mode that is mapped exists in DJI's SDK`() {
        val names = enumNames(FCFlightMode::class.java)
        val mapped =
            names.associateWith { DjiSnapshot(1, flightMode = it).mode }.filterValues { it != FlightMode.OTHER }
        assertEquals(24, mapped.size)
        assertEquals(FlightMode.WAYPOINT, mapped["NAVI_GO"])
        assertEquals(FlightMode.JOYSTICK, mapped["JOYSTICK"])
    }

    private fun functions(state: AircraftState) =
        state.capabilities.run { listOf(waypointMissions, virtualStick, camera) }

    private fun warning(isLow: Boolean, isSerious: Boolean) =
        aircraftState(FLYING.copy(isLowBattery = isLow, isSeriousLowBattery = isSerious), false)!!.batteryWarning

    private fun failsafe(name: String?) = aircraftState(FLYING.copy(failsafe = name), false)!!.capabilities.failsafe
}
