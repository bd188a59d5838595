package recon.msdk5

import recon.aircraft.AircraftCommand
import recon.aircraft.Answer
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import recon.aircraft.StickSetpoint
import recon.aircraft.VideoFrame
import recon.geo.LatLon
import recon.mission.planOfKmz
import java.io.ByteArrayInputStream
import java.util.zip.ZipInputStream
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertIs
import kotlin.test.assertTrue

class Msdk5AircraftTest {
    private val sdk = RecordingSdk()
    private val aircraft = Msdk5Aircraft(sdk) { 1_700_000_000_000 }
    private val answers = mutableListOf<Answer>()
    private val setpoint = StickSetpoint(false, 45.0, 5.0, -2.0, 30.0)
    private val plan = MissionPlan(
        listOf(PlanPoint(LatLon(45.0, -93.0), 30.0, 5.0, 0.2), PlanPoint(LatLon(45.001, -93.0), 30.0, 5.0, 0.2)),
        isCurved = false,
        landsAtEnd = true,
    )

    @Test
    fun `a hover that has nothing to end makes no call`() {
        execute(AircraftCommand.Hover)
        assertEquals(emptyList(), sdk.calls)
        assertEquals(listOf<Answer>(Answer.Accepted), answers)
    }

    @Test
    fun `a hover ends what is flown, each by its own call`() {
        for ((mode, call) in mapOf(
            "GO_HOME" to "STOP_GO_HOME",
            "AUTO_LANDING" to "STOP_AUTO_LANDING",
            "CONFIRM_LANDING" to "STOP_AUTO_LANDING",
            "AUTO_TAKE_OFF" to "STOP_TAKEOFF",
            "MOTOR_START" to "STOP_TAKEOFF",
        )) {
            sdk.calls.clear()
            sdk.snapshot = FLYING.copy(flightMode = mode)
            execute(AircraftCommand.Hover)
            assertEquals(listOf(call), sdk.calls, mode)
        }
    }

    @Test
    fun `sticks end with one setpoint without velocity, then go back to the controller`() {
        sdk.snapshot = FLYING.copy(flightMode = "JOYSTICK", isVirtualStickEnabled = true)
        execute(AircraftCommand.SetStick(setpoint))
        execute(AircraftCommand.Hover)
        assertEquals(listOf("stick", "stick", "disable sticks"), sdk.calls)
        assertEquals(listOf(5.0, 0.0), sdk.sticks.map { it.rollMps })
    }

    @Test
    fun `virtual stick is enabled before the first setpoint, and repeats wait for it`() {
        sdk.waiting = mutableListOf()
        execute(AircraftCommand.SetStick(setpoint))
        execute(AircraftCommand.SetStick(setpoint.copy(velocityXMps = 6.0)))
        assertEquals(listOf("enable sticks"), sdk.calls)
        sdk.waiting!!.single()(null)
        assertEquals(listOf(6.0), sdk.sticks.map { it.rollMps })
        assertEquals(2, answers.count { it is Answer.Accepted })
    }

    @Test
    fun `a stop while virtual stick is being enabled sends no motion when it is`() {
        sdk.waiting = mutableListOf()
        execute(AircraftCommand.SetStick(setpoint))
        execute(AircraftCommand.Hover)
        sdk.waiting!!.toList().forEach { it(null) }
        assertTrue(sdk.sticks.all { it.rollMps == 0.0 && it.pitchMps == 0.0 })
        assertEquals("disable sticks", sdk.calls.last { it != "stick" })
    }

    @Test
    fun `sticks that DJI refuses are refused with its reason`() {
        sdk.errors["enable sticks"] = DjiError("41", "not in normal mode")
        execute(AircraftCommand.SetStick(setpoint))
        assertEquals(listOf<Answer>(Answer.Refused("not in normal mode (41)")), answers)
        assertEquals(emptyList(), sdk.sticks)
        sdk.errors.clear()
        execute(AircraftCommand.SetStick(setpoint))
        assertEquals(1, sdk.sticks.size)
    }

    @Test
    fun `X is DJI's roll, Y its pitch, and the height is held by a vertical velocity`() {
        sdk.snapshot = FLYING.copy(isVirtualStickEnabled = true)
        execute(AircraftCommand.SetStick(setpoint.copy(isBodyFrame = true)))
        assertEquals(DjiStick(true, 5.0, -2.0, 45.0, 3.0), sdk.sticks.single())
        assertEquals(0.5, Msdk5Aircraft.verticalMps(21.0, 20.0))
        assertEquals(-3.0, Msdk5Aircraft.verticalMps(0.0, 20.0))
        assertEquals(0.0, Msdk5Aircraft.verticalMps(30.0, null))
        assertEquals(0.0, Msdk5Aircraft.verticalMps(30.0, Double.NaN))
    }

    @Test
    fun `a mission is uploaded as a file that reads back, then started`() {
        execute(AircraftCommand.FlyMission(plan))
        execute(AircraftCommand.FlyMission(plan))
        assertEquals(listOf("push recon-1", "start recon-1", "push recon-2", "start recon-2"), sdk.calls)
        assertEquals(plan.points.map { it.position }, planOfKmz(sdk.files.first()).points.map { it.position })
        assertTrue(planOfKmz(sdk.files.first()).landsAtEnd)
    }

    @Test
    fun `the mission being flown is stopped by its name`() {
        execute(AircraftCommand.FlyMission(plan))
        sdk.calls.clear()
        sdk.snapshot = FLYING.copy(flightMode = "NAVI_GO", missionState = "EXECUTING")
        execute(AircraftCommand.GoHome)
        assertEquals(listOf("stop recon-1", "START_GO_HOME"), sdk.calls)
    }

    @Test
    fun `each failure of a mission is its own sentence, with DJI's code and what to try`() {
        val load = DjiError("WPMZ_FILE_LOAD_ERROR", "Failed to start task. Check whether the wayline file is correct")
        for ((call, error, expected) in listOf(
            Triple("push", DjiError("REQUEST_HANDLER_NOT_FOUND", "none"), "Upload failed: none (REQUEST_HANDLER_NOT"),
            Triple("start", load, "Uploaded, but the aircraft cannot load the file: Failed to start task. Check"),
            Triple("start", DjiError("TRAJ_INIT_FAIL", "x"), "Uploaded, but the aircraft cannot load the file: x (T"),
            Triple("start", DjiError("GPS_INVALID", "y"), "Uploaded, but not started: y (GPS_INVALID). To try: wait"),
        )) {
            answers.clear()
            sdk.errors.clear()
            sdk.errors[call] = error
            execute(AircraftCommand.FlyMission(plan))
            val reason = assertIs<Answer.Refused>(answers.single()).reason
            assertTrue(reason.startsWith(expected) && ". To try: " in reason, reason)
        }
        sdk.errors["start"] = DjiError("99", "unheard of")
        execute(AircraftCommand.FlyMission(plan))
        assertEquals(Answer.Refused("Uploaded, but not started: unheard of (99)"), answers.last())
    }

    @Test
    fun `a failed upload starts nothing, and a plan that cannot be flown reaches nothing`() {
        sdk.errors["push"] = DjiError("FILE_TRANSFER_FAIL", "upload failed")
        execute(AircraftCommand.FlyMission(plan))
        assertEquals(listOf("push recon-1"), sdk.calls)
        execute(AircraftCommand.FlyMission(plan.copy(points = plan.points.take(1))))
        assertEquals(Answer.Refused("A mission has 2 to 99 waypoints; got 1"), answers.last())
        assertEquals(1, sdk.calls.size)
    }

    @Test
    fun `a file in which DJI's check finds a fault is not uploaded, and the check's answer is told`() {
        execute(AircraftCommand.FlyMission(plan))
        val note = assertIs<Answer.Noted>(answers.last()).note
        assertEquals("its file is for a Mavic 3E; DJI's check found no fault", note)
        sdk.check = FileCheck.Absent("this build lacks it")
        execute(AircraftCommand.FlyMission(plan))
        assertTrue("was not made, because this build lacks it" in assertIs<Answer.Noted>(answers.last()).note)
        sdk.calls.clear()
        sdk.check = FileCheck.Faulty(listOf(-10, 7))
        execute(AircraftCommand.FlyMission(plan))
        val reason = assertIs<Answer.Refused>(answers.last()).reason
        assertTrue("heading mode (-10), unknown fault (7)" in reason, reason)
        assertEquals(emptyList(), sdk.calls)
    }

    @Test
    fun `a mission's file has the numbers of the aircraft and its camera, and photos where the model takes them`() {
        val timed = plan.copy(photoEveryS = 2.0)
        for ((product, camera, expected) in listOf(
            Triple("DJI_MATRICE_4D_SERIES", "M4TD", Triple("a Matrice 4TD", 2.0, listOf("100", "1", "99"))),
            Triple("M350_RTK", "ZENMUSE_H20T", Triple("a Matrice 350", 2.0, listOf("89", "0", "43"))),
            Triple("M350_RTK", "ZENMUSE_P1", Triple("a Matrice 350", null, listOf("89", "0"))),
            Triple("DJI_MINI_4_PRO", "DJI_MINI_4_PRO", Triple("a Mini 4 Pro", null, listOf("68", "0"))),
            Triple("UNRECOGNIZED", "NOT_SUPPORTED", Triple("no aircraft", null, emptyList())),
        )) {
            val (words, everyS, numbers) = expected
            sdk.snapshot = FLYING.copy(product = product, camera = camera)
            execute(AircraftCommand.FlyMission(timed))
            assertEquals(everyS, planOfKmz(sdk.files.last()).photoEveryS, camera)
            assertEquals(numbers, numbersIn(sdk.files.last()), camera)
            val note = assertIs<Answer.Noted>(answers.last()).note
            assertTrue(words in note && (everyS != null || "it takes no photos with this aircraft" in note), note)
        }
    }

    private fun numbersIn(kmz: ByteArray): List<String> {
        val zip = ZipInputStream(ByteArrayInputStream(kmz))
        generateSequence { zip.nextEntry }.first { it.name == "wpmz/waylines.wpml" }
        val wayline = zip.readBytes().decodeToString()
        return Regex("EnumValue>(\\d+)<").findAll(wayline).map { it.groupValues[1] }.toList()
    }

    @Test
    fun `a newer order drops the steps that an older one has left`() {
        sdk.waiting = mutableListOf()
        execute(AircraftCommand.FlyMission(plan))
        sdk.snapshot = FLYING.copy(missionState = "UPLOADING")
        execute(AircraftCommand.Land)
        val (push, landing) = sdk.waiting!!
        push(null)
        landing(null)
        landing(null)
        assertEquals(listOf("push recon-1", "START_AUTO_LANDING"), sdk.calls)
        assertIs<Answer.Refused>(answers.first())
        assertEquals(Answer.Accepted, answers.last())
        assertEquals(2, answers.size)
    }

    @Test
    fun `a landing or return that goes on is not begun again, and its confirmation ends nothing`() {
        sdk.snapshot = FLYING.copy(flightMode = "CONFIRM_LANDING")
        execute(AircraftCommand.Land)
        execute(AircraftCommand.ConfirmLanding)
        sdk.snapshot = FLYING.copy(flightMode = "GO_HOME")
        execute(AircraftCommand.GoHome)
        assertEquals(listOf("CONFIRM_LANDING"), sdk.calls)
        execute(AircraftCommand.TakeOff)
        assertEquals("START_TAKEOFF", sdk.calls.last())
    }

    @Test
    fun `frames pass while the feed is on, and those of a wrong size do not`() {
        val frames = mutableListOf<VideoFrame>()
        aircraft.onFrame { frames += it }
        execute(AircraftCommand.SetVideo(isOn = true))
        sdk.frames!!(ByteArray(12), 4, 2)
        for ((bytes, width, height) in listOf(Triple(11, 4, 2), Triple(9, 3, 2), Triple(9, 2, 3))) {
            sdk.frames!!(ByteArray(bytes), width, height)
        }
        assertEquals(1, frames.size)
        execute(AircraftCommand.SetVideo(isOn = false))
        assertEquals(null, sdk.frames)
    }

    private fun execute(command: AircraftCommand) = aircraft.execute(command) { answers += it }
}
