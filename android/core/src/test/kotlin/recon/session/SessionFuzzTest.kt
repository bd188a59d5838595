package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.Answer
import recon.aircraft.FlightMode
import recon.aircraft.MissionAction
import recon.wire.CameraControl
import recon.wire.FUZZ_INPUTS
import recon.wire.drawnPart
import recon.wire.drawnStream
import kotlin.random.Random
import kotlin.test.Test
import kotlin.test.assertTrue

/** Hostile bytes, states and times: no exception, and what the aircraft gets is always finite and in range. */
class SessionFuzzTest {

    @Test
    fun `whatever the station sends, the aircraft gets only sound commands`() {
        var commands = 0
        for (round in 0 until FUZZ_INPUTS / 50) commands += fuzzed(Random(round))
        assertTrue(commands > FUZZ_INPUTS / 50, "$commands commands")
    }

    private fun fuzzed(random: Random): Int {
        val harness = Harness(isReading = random.nextInt(10) > 0).connect()
        repeat(50) {
            when (random.nextInt(11)) {
                0 -> harness.state = drawnState(random)
                1 -> harness.passInSilence(random.nextLong(3) * SECOND)
                2 -> harness.session.received(drawnStream(random), harness.nowNs)
                3 -> harness.session.received(commandLike(random), harness.nowNs)
                4 -> if (random.nextInt(5) == 0) reconnect(harness) else harness.receive(HOVER)
                5 -> harness.receive(CameraControl(random.nextInt(5), random.nextFloat()))
                6 -> harness.session.photoTaken(drawnPhoto(random, harness.nowNs), harness.nowNs)
                7 -> harness.answers = drawnAnswer(random)
                else -> harness.session.received(drawnPart(random), harness.nowNs)
            }
            harness.pass(random.nextLong(40) * MS)
        }
        harness.commands.forEach(::assertSound)
        harness.appTexts.forEach(::assertStrict)
        return harness.commands.size
    }

    private fun reconnect(harness: Harness) {
        harness.closeLink()
        harness.session.linkOpened(harness.nowNs)
        harness.settle()
    }

    private fun drawnState(random: Random) = when (random.nextInt(4)) {
        0 -> null
        1 -> standing()
        else -> hovering(mode = FlightMode.entries.random(random)).copy(facts = AppTextsTest.drawnFacts(random))
    }

    private fun drawnAnswer(random: Random): Answer? = when (random.nextInt(4)) {
        0 -> null
        1 -> Answer.Noted(AppTextsTest.drawnName(random))
        2 -> Answer.Refused(AppTextsTest.drawnName(random), AppTextsTest.drawnName(random), MissionAction.LOAD)
        else -> Answer.Accepted
    }

    private fun drawnPhoto(random: Random, nowNs: Long) = AppTextsTest.drawnPhoto(random).copy(
        takenNs = nowNs - random.nextLong(-SECOND, 4_000 * SECOND), serial = AppTextsTest.drawnName(random),
    )

    /** What the station's reader refuses would be lost whole: JSON of one object, and its size. */
    private fun assertStrict(text: String) {
        assertTrue(text.encodeToByteArray().size <= LONGEST_APP_TEXT_BYTES, text)
        AppTextsTest.objectOf(text)
    }

    private fun commandLike(random: Random): ByteArray {
        val yawDeg = random.nextFloat() * 400f - 200f
        val stick = OrdersTest.STICK.copy(timeoutS = random.nextFloat() * 70f, yawDeg = yawDeg)
        return recon.wire.encode(if (random.nextBoolean()) stick else mission())
    }

    private fun assertSound(command: AircraftCommand) {
        when (command) {
            is AircraftCommand.SetStick -> with(command.setpoint) {
                assertTrue(velocityXMps in -15.0..15.0 && velocityYMps in -15.0..15.0, "$this")
                assertTrue(yawDeg in -180.0..180.0 && heightAboveTakeoffM in 0.0..500.0, "$this")
            }
            is AircraftCommand.FlyMission -> for (point in command.plan.points) {
                assertTrue(point.position.latitudeDeg in -90.0..90.0 && point.speedMps in 0.99..15.01, "$point")
                assertTrue(point.heightAboveTakeoffM in -200.01..500.01, "$point")
            }
            else -> Unit
        }
    }
}
