package recon.msdk5

import recon.aircraft.AircraftCommand
import recon.aircraft.Answer
import recon.aircraft.MissionAction
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import recon.aircraft.ReleasedPhoto
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
    private var nowNs = 0L
    private val aircraft = Msdk5Aircraft(sdk, { nowNs }, { 1_700_000_000_000 })
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
        assertEquals(listOf<Answer>(Answer.Refused("not in normal mode (41)", "41")), answers)
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
        val names = listOf(1, 2).map { "recon-1700000000-$it" }
        assertEquals(names.flatMap { listOf("push $it", "start $it") }, sdk.calls)
        assertEquals(plan.points.map { it.position }, planOfKmz(sdk.files.first()).points.map { it.position })
        assertTrue(planOfKmz(sdk.files.first()).landsAtEnd)
    }

    @Test
    fun `the mission being flown is stopped by its name`() {
        execute(AircraftCommand.FlyMission(plan))
        sdk.calls.clear()
        sdk.snapshot = FLYING.copy(flightMode = "NAVI_GO", missionState = "EXECUTING")
        execute(AircraftCommand.GoHome)
        assertEquals(listOf("stop recon-1700000000-1", "START_GO_HOME"), sdk.calls)
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
        val unheard = Answer.Refused("Uploaded, but not started: unheard of (99)", "99", MissionAction.START)
        assertEquals(unheard, answers.last())
    }

    @Test
    fun `a failed upload starts nothing, and a plan that cannot be flown reaches nothing`() {
        sdk.errors["push"] = DjiError("FILE_TRANSFER_FAIL", "upload failed")
        execute(AircraftCommand.FlyMission(plan))
        assertEquals(listOf("push recon-1700000000-1"), sdk.calls)
        execute(AircraftCommand.FlyMission(plan.copy(points = plan.points.take(1))))
        assertEquals(
            Answer.Refused("A mission has 2 to 99 waypoints; got 1", action = MissionAction.UPLOAD), answers.last(),
        )
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
            assertTrue(words in note && (everyS != null || "it takes no photos" in note), note)
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
        assertEquals(listOf("push recon-1700000000-1", "START_AUTO_LANDING"), sdk.calls)
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
    fun `a mission that another app has started is stopped by its name, or held without one`() {
        sdk.snapshot = FLYING.copy(flightMode = "NAVI_GO", missionState = "EXECUTING", missionName = "theirs")
        execute(AircraftCommand.Hover)
        sdk.snapshot = FLYING.copy(flightMode = "NAVI_GO", missionState = "EXECUTING")
        execute(AircraftCommand.Hover)
        assertEquals(listOf("stop theirs", "pause"), sdk.calls)
    }

    @Test
    fun `what had ended already keeps no order from being carried out`() {
        sdk.snapshot = FLYING.copy(missionState = "EXECUTING", missionName = "a", isVirtualStickEnabled = true)
        sdk.errors["stop"] = DjiError("CANNOT_STOP_WAYLINE_WHEN_WAYLINE_NOT_RUNNING", "not running")
        execute(AircraftCommand.Hover)
        sdk.errors["disable"] = DjiError("TIMEOUT", "no answer")
        execute(AircraftCommand.GoHome)
        assertEquals(listOf<Answer>(Answer.Accepted, Answer.Accepted), answers)
        assertEquals("START_GO_HOME", sdk.calls.last())
        sdk.errors["stop"] = DjiError("SYSTEM_ERROR", "x")
        sdk.errors.remove("disable")
        execute(AircraftCommand.Hover)
        assertEquals(Answer.Refused("x (SYSTEM_ERROR)", "SYSTEM_ERROR"), answers.last())
    }

    @Test
    fun `an attempt to enable virtual stick that is never answered is given up`() {
        sdk.waiting = mutableListOf()
        execute(AircraftCommand.SetStick(setpoint))
        nowNs = 4_000_000_000
        execute(AircraftCommand.SetStick(setpoint))
        assertEquals(1, sdk.calls.size)
        nowNs = 5_100_000_000
        execute(AircraftCommand.SetStick(setpoint))
        assertEquals(listOf("enable sticks", "enable sticks"), sdk.calls)
    }

    @Test
    fun `no step begins when the operator has been told that there was no answer`() {
        sdk.waiting = mutableListOf()
        execute(AircraftCommand.FlyMission(plan))
        nowNs = 20_000_000_000
        sdk.waiting!!.single()(null)
        assertEquals(1, sdk.calls.size)
        assertTrue("took too long" in assertIs<Answer.Refused>(answers.single()).reason)
    }

    @Test
    fun `a survey's mission takes its photos at the camera's interval, unless its timer is on`() {
        val survey = plan.copy(points = listOf(plan.points[0].copy(gimbalPitchDeg = -90.0), plan.points[1]))
        for ((mode, everyS) in listOf("PHOTO_NORMAL" to 2.0, "PHOTO_INTERVAL" to null)) {
            nowNs += 2_000_000_000
            sdk.readings = DjiReadings(cameraMode = mode, photoIntervalS = 2.0)
            execute(AircraftCommand.FlyMission(survey))
            assertEquals(everyS, planOfKmz(sdk.files.last()).photoEveryS)
        }
        execute(AircraftCommand.FlyMission(plan))
        assertEquals(null, planOfKmz(sdk.files.last()).photoEveryS)
    }

    @Test
    fun `facts are read once a second, and at once for another aircraft`() {
        sdk.readings = DjiReadings(heightLimitM = 120)
        repeat(5) { assertEquals(120.0, aircraft.state()!!.facts.maxHeightM) }
        assertEquals(1, sdk.readingsCount)
        sdk.snapshot = FLYING.copy(serial = "OTHER")
        sdk.readings = DjiReadings(heightLimitM = 60)
        assertEquals(60.0, aircraft.state()!!.facts.maxHeightM)
        nowNs = 1_000_000_000
        aircraft.state()
        assertEquals(3, sdk.readingsCount)
    }

    @Test
    fun `a camera is locked as it is, and gets its white balance back`() {
        sdk.readings = DjiReadings(whiteBalance = WhiteBalance("AUTO", 56))
        for (isLocked in listOf(true, false, false)) execute(AircraftCommand.LockCamera(isLocked))
        val expected = listOf("true", "white balance MANUAL 56", "false", "white balance AUTO 56", "false")
        assertEquals(expected, sdk.calls.map { it.removePrefix("lock exposure ") })
        sdk.calls.clear()
        sdk.readings = DjiReadings(whiteBalance = WhiteBalance("SUNNY", null))
        execute(AircraftCommand.LockCamera(true))
        sdk.readings = DjiReadings(whiteBalance = WhiteBalance("AUTO", 0))
        execute(AircraftCommand.LockCamera(true))
        assertEquals(listOf("lock exposure true", "lock exposure true"), sdk.calls)
        val reason = assertIs<Answer.Refused>(answers.last()).reason
        assertTrue(reason.startsWith("the exposure is locked, the white balance is not"), reason)
    }

    @Test
    fun `a photo has time and place of its shutter`() {
        val photos = mutableListOf<ReleasedPhoto>()
        aircraft.onPhoto { photos += it }
        nowNs = 100
        sdk.camera!!(CameraEvent.Shutter)
        nowNs = 900_000_000
        sdk.snapshot = FLYING.copy(latitudeDeg = 46.0)
        sdk.camera!!(CameraEvent.StoredFile("JPEG", 100, 7))
        assertEquals(100 to LatLon(45.0, -93.0), photos.single().let { it.takenNs.toInt() to it.position })
        assertEquals("wide" to "1581F5BKD22BJ00A", photos.single().let { it.lens to it.serial })
        aircraft.onPhoto(null)
        assertEquals(null, sdk.camera)
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
