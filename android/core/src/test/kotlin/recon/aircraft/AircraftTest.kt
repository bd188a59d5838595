package recon.aircraft

import recon.geo.LatLon
import recon.geo.LocalPlane
import recon.geo.distanceM
import recon.session.hovering
import recon.sim.testPicture
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertFailsWith
import kotlin.test.assertNull
import kotlin.test.assertTrue

class AircraftTest {

    @Test
    fun `a waypoint's altitude becomes a height above takeoff in one way for each revision`() {
        assertEquals(30.0, AltitudeReference.TAKEOFF.heightAboveTakeoffM(30.0, null))
        assertEquals(30.0, AltitudeReference.WGS84.heightAboveTakeoffM(310.0, 280.0))
        assertNull(AltitudeReference.WGS84.heightAboveTakeoffM(310.0, null))
    }

    @Test
    fun `what telemetry adds, waypoints lose again, however wrong the takeoff altitude is`() {
        val state = hovering().copy(takeoffAltitudeM = -47.3)
        assertEquals(20.0, AltitudeReference.WGS84.heightAboveTakeoffM(state.altitudeM(), state.takeoffAltitudeM))
    }

    @Test
    fun `takeoff counts neither as ground nor as flight`() {
        val starting = hovering().copy(isFlying = false, flightMode = FlightMode.MOTORS_JUST_STARTED)
        assertTrue(!starting.isOnGround && !starting.isFlying)
        assertTrue(hovering().copy(isFlying = false).isOnGround)
        assertTrue(!hovering().isOnGround)
    }

    @Test
    fun `NV21 becomes RGB by the definition of BT 601`() {
        // One block of 2 x 2 pixels each: grey, pure red, pure blue as in the standard's table.
        assertEquals(listOf(128, 128, 128), rgbOf(128, 128, 128))
        assertEquals(listOf(254, 0, 0), rgbOf(76, 255, 85))
        assertEquals(listOf(0, 0, 254), rgbOf(29, 107, 255))
        assertEquals(4 * 2 * 3, testPicture(4, 2).toRgb().size)
    }

    @Test
    fun `a frame of another size than its bytes is refused`() {
        assertFailsWith<IllegalArgumentException> { VideoFrame(3, 2, ByteArray(9)) }
        assertFailsWith<IllegalArgumentException> { VideoFrame(2, 3, ByteArray(9)) }
        assertFailsWith<IllegalArgumentException> { VideoFrame(2, 2, ByteArray(5)) }
    }

    @Test
    fun `a local plane agrees with the length of a degree of WGS84`() {
        // At 45 degrees a degree of latitude is 111,132 m and one of longitude 78,847 m.
        val plane = LocalPlane(LatLon(45.0, 7.0))
        assertEquals(111.132, plane.northM(LatLon(45.001, 7.0)), 0.001)
        assertEquals(78.847, plane.eastM(LatLon(45.0, 7.001)), 0.001)
        val back = plane.position(100.0, -50.0)
        assertEquals(100.0, plane.northM(back), 1e-6)
        assertEquals(-50.0, plane.eastM(back), 1e-6)
        assertEquals(5.0, distanceM(back, 3.0, back, 8.0), 1e-9)
    }

    private fun rgbOf(luma: Int, v: Int, u: Int): List<Int> {
        val nv21 = ByteArray(6) { if (it < 4) luma.toByte() else if (it == 4) v.toByte() else u.toByte() }
        return VideoFrame(2, 2, nv21).toRgb().take(3).map { it.toInt() and 0xFF }
    }
}
