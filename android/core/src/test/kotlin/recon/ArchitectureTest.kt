package recon

import java.io.File
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertTrue

/** What the core must not use: clocks and threads outside its shell, and what a phone does not have. */
class ArchitectureTest {
    private val root = File("src/main/kotlin/recon")
    private val files = root.walk().filter { it.extension == "kt" }.toList()

    @Test
    fun `sockets, threads and clocks are in the shell alone`() {
        val impure =
            Regex("""java\.net\.|java\.util\.concurrent|\bThread\b|System\.(nanoTime|currentTimeMillis)|Instant\.now""")
        assertEquals(emptyList(), files.filterNot(::isShell).filter { impure.containsMatchIn(it.readText()) })
        assertTrue(files.filter(::isShell).any { impure.containsMatchIn(it.readText()) })
    }

    @Test
    fun `random numbers are seeded`() {
        val unseeded = Regex("""Random(\(\)|\.Default|\.next)""")
        assertEquals(emptyList(), files.filter { unseeded.containsMatchIn(it.readText()) })
    }

    @Test
    fun `nothing is used that only Android, DJI or a desktop has`() {
        val names = "android|dji|java\\.awt|javax\\.imageio|javax\\.swing|javax\\.xml\\.stream"
        val foreign = Regex("^import ($names)\\b", RegexOption.MULTILINE)
        assertEquals(emptyList(), files.filter { foreign.containsMatchIn(it.readText()) })
    }

    @Test
    fun `rooms import downwards only`() {
        val order = listOf("errors", "wire", "geo", "aircraft", "mission", "session", "sim", "link")
        for (file in files) {
            val room = order.indexOf(file.parentFile.name)
            val imports = Regex("""^import recon\.(\w+)\.""", RegexOption.MULTILINE).findAll(file.readText())
            val upwards = imports.map { it.groupValues[1] }.filter { order.indexOf(it) > room }.toList()
            assertEquals(emptyList(), upwards, file.path)
        }
    }

    private fun isShell(file: File) = file.parentFile.name == "link" || file.name == "SimulatedAircraft.kt"
}
