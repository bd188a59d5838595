package recon.app

import java.io.File
import java.io.IOException
import java.time.Instant
import java.time.temporal.ChronoUnit
import java.util.concurrent.Executor

/**
 * The log to share after a flight: one file of text per connection, the newest ten. Lines are written by
 * [executor], so that storage does not hold up the session.
 */
class FlightLog(private val folder: File, private val executor: Executor, private val now: () -> Instant) {
    @Volatile
    private var file: File? = null

    /** The newest log file, or null without one. */
    fun newest(): File? = files().lastOrNull()

    /** Begins a new file, and removes the oldest. */
    fun begin() {
        val name = now().truncatedTo(ChronoUnit.SECONDS).toString().replace(":", "")
        file = File(folder, "recon-$name.log")
        executor.execute {
            folder.mkdirs()
            files().dropLast(MOST_FILES - 1).forEach { it.delete() }
        }
    }

    /** Adds a line; nothing from the network can add more than one. */
    fun add(kind: String, text: String) {
        val target = file ?: return
        val line = "${now()} ${kind.padEnd(7)} ${text.replace(Regex("\\p{Cntrl}"), " ")}\n"
        executor.execute { append(target, line) }
    }

    private fun append(target: File, line: String) {
        try {
            if (target.length() + line.length <= LONGEST_BYTES) target.appendText(line)
        } catch (_: IOException) {
            // A full or removed storage costs the log, not the flight.
        }
    }

    /** Names begin with the time: the order of names is that of times. */
    private fun files(): List<File> = folder.listFiles { file -> file.name.endsWith(".log") }.orEmpty().sorted()

    private companion object {
        const val MOST_FILES = 10
        const val LONGEST_BYTES = 8_000_000L
    }
}
