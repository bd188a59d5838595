package recon.sim

import recon.aircraft.Aircraft
import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.VideoFrame
import java.util.concurrent.Executors
import java.util.concurrent.ScheduledExecutorService
import java.util.concurrent.TimeUnit

/** A simulated flight behind the port of a real aircraft: it flies by a clock and films on a thread of its own. */
class SimulatedAircraft(
    settings: SimulatedSettings,
    private val picture: VideoFrame = testPicture(640, 360),
    private val clockNs: () -> Long = System::nanoTime,
) : Aircraft, AutoCloseable {
    private val flight = SimulatedFlight(settings, clockNs())
    private var camera: ScheduledExecutorService? = null

    @Volatile
    private var listener: ((VideoFrame) -> Unit)? = null

    @Synchronized
    override fun state(): AircraftState {
        flight.advance(clockNs())
        return flight.state()
    }

    override fun execute(command: AircraftCommand, answered: (Answer) -> Unit) {
        answered(executed(command))
    }

    override fun onFrame(listener: ((VideoFrame) -> Unit)?) {
        this.listener = listener
    }

    @Synchronized
    override fun close() = film(isOn = false)

    @Synchronized
    private fun executed(command: AircraftCommand): Answer {
        flight.advance(clockNs())
        if (command is AircraftCommand.SetVideo) film(command.isOn)
        return flight.execute(command)
    }

    private fun film(isOn: Boolean) {
        camera?.shutdownNow()
        camera = if (isOn) filming() else null
    }

    private fun filming(): ScheduledExecutorService {
        val executor = Executors.newSingleThreadScheduledExecutor { Thread(it, "camera").apply { isDaemon = true } }
        executor.scheduleAtFixedRate({ listener?.invoke(picture) }, 0, FRAME_PERIOD_MS, TimeUnit.MILLISECONDS)
        return executor
    }

    private companion object {
        /** 30 frames a second, as DJI's feed. */
        const val FRAME_PERIOD_MS = 33L
    }
}

/** A picture with a gradient and coloured quarters, so that a turned or torn frame shows. */
fun testPicture(width: Int, height: Int): VideoFrame {
    val luma = ByteArray(width * height) { (40 + 180 * (it % width) / width).toByte() }
    val chroma = ByteArray(width * height / 2) { index ->
        val isUpper = index / width < height / 4
        val isLeft = index % width < width / 2
        // V and U alternate: one shows above and below, the other left and right.
        if ((index % 2 == 0 && isUpper) || (index % 2 == 1 && isLeft)) 90 else 170.toByte()
    }
    return VideoFrame(width, height, luma + chroma)
}
