package recon.mission

import recon.aircraft.AltitudeReference
import recon.aircraft.MissionPlan
import recon.session.mission
import recon.session.waypoint
import recon.wire.ExecuteWaypointMission
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertIs
import kotlin.test.assertTrue

class MissionRulesTest {

    @Test
    fun `a mission becomes a plan with actions or none`() {
        val packet = mission(waypoint(0.0).copy(loiterTimeS = 3f, gimbalPitchDeg = -45f), waypoint(0.001))
        val plan = assertIs<PlanResult.Ready>(planned(packet.copy(landAtEnd = 1))).plan
        assertEquals(listOf(3.0 to -45.0, null to null), plan.points.map { it.loiterS to it.gimbalPitchDeg })
        assertEquals(true to false, plan.landsAtEnd to plan.isCurved)
    }

    @Test
    fun `each limit has a sentence with value and range`() {
        val good = waypoint(0.001)
        assertRefused("Waypoint 1: latitude must be -90 to 90 degrees; got 95", good.copy(latitudeDeg = 95.0))
        val nowhere = good.copy(longitudeDeg = Double.NaN)
        assertRefused("Waypoint 1: longitude must be -180 to 180 degrees; got NaN", nowhere)
        assertRefused("Waypoint 1: height above takeoff must be -200 to 500 m; got 501", good.copy(altitudeM = 501.0))
        assertRefused("Waypoint 1: speed must be 1 to 15 m/s; got 0.50", good.copy(speedMps = 0.5f))
        val endless = good.copy(speedMps = Float.POSITIVE_INFINITY)
        assertRefused("Waypoint 1: speed must be 1 to 15 m/s; got Infinity", endless)
        assertRefused("Waypoint 1: loiter must be 0 to 32.77 s; got 40", good.copy(loiterTimeS = 40f))
        assertRefused("Waypoint 1: gimbal pitch must be -90 to 0 degrees; got 30", good.copy(gimbalPitchDeg = 30f))
        assertRefused("Waypoints must be 0.50 to 2000 m apart; got 0 m", waypoint(0.0))
        // 0.2 degrees of latitude, at 111.1 km each.
        val far = reason(mission(waypoint(0.2), waypoint(0.0)))
        assertTrue(far.startsWith("Waypoints must be 0.50 to 2000 m apart; got 222"))
    }

    @Test
    fun `flags outside the document and a path too long are refused`() {
        assertEquals("LandAtEnd must be 0 or 1; got 2", reason(mission().copy(landAtEnd = 2)))
        assertEquals("CurvedFlight must be 0 or 1; got 3", reason(mission().copy(curvedFlight = 3)))
        // There and back by 1.9 km, nineteen times: 36 km, and no leg too long.
        val long = List(20) { waypoint(if (it % 2 == 0) 0.0 else 0.0171, altitudeM = 30.0 + it) }
        assertTrue(reason(mission(*long.toTypedArray())).startsWith("A mission's path is at most 30000 m; got 361"))
    }

    @Test
    fun `what a curved mission cannot have is refused`() {
        fun curved(vararg change: Pair<Int, (recon.wire.Waypoint) -> recon.wire.Waypoint>): ExecuteWaypointMission {
            val changes = change.toMap()
            val points = List(3) { index ->
                (changes[index] ?: { it })(waypoint(0.001 * index).copy(cornerRadiusM = 20f))
            }
            return mission(*points.toTypedArray()).copy(curvedFlight = 1)
        }
        assertIs<PlanResult.Ready>(planned(curved()))
        val noActions = "Waypoint 2: a curved mission does not stop, so it has no loiter or gimbal action"
        assertEquals(noActions, reason(curved(1 to { it.copy(loiterTimeS = 1f) })))
        assertEquals(noActions, reason(curved(1 to { it.copy(gimbalPitchDeg = -1f) })))
        assertEquals(
            "Corner radius of a curved mission must be over 0 m", reason(curved(1 to { it.copy(cornerRadiusM = 0f) })),
        )
        assertEquals(
            "Leg 1: the corner radii at its ends must add to less than its 111.13 m; got 200",
            reason(curved(1 to { it.copy(cornerRadiusM = 200f) })).take(79),
        )
    }

    @Test
    fun `numbers are shown short`() {
        assertEquals(listOf("3", "-0.25", "NaN", "1.0E12"), listOf(3.0, -0.25, Double.NaN, 1e12).map(::shown))
    }

    @Test
    fun `a plan without points is refused`() {
        assertEquals("A mission has 2 to 99 waypoints; got 0", planProblem(MissionPlan(emptyList(), false, false)))
    }

    private fun planned(packet: ExecuteWaypointMission) = planOf(packet, AltitudeReference.TAKEOFF, null)

    private fun reason(packet: ExecuteWaypointMission) = assertIs<PlanResult.Refused>(planned(packet)).reason

    private fun assertRefused(expected: String, first: recon.wire.Waypoint) {
        assertEquals(expected, reason(mission(first, waypoint(0.0))))
    }
}
