package recon.msdk5

import java.io.File
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertTrue

/**
 * Every class, method and field of DJI's SDK and of Android that the adapter refers to exists in the
 * signatures it was compiled against, and only `Msdk5` refers to DJI at all. DJI's own runtime is packed:
 * more than this cannot be checked without a phone.
 */
class LinkageTest {
    private val linkage = Linkage()
    private val references = linkage.referencesOf(File("target/classes"))

    @Test
    fun `nothing that the adapter refers to is missing`() {
        val all = references.values.flatten().toSet()
        assertTrue(all.count { it.owner.startsWith("dji/") } > 60, "${all.size} references")
        println("${all.size} references to DJI's SDK and Android, checked")
        assertEquals(emptyList(), all.filterNot(linkage::exists).map { it.toString() })
    }

    @Test
    fun `only the thin layer refers to DJI`() {
        val files = references.filterValues { found -> found.any { it.owner.startsWith("dji/") } }.keys
        val isThinLayer = Regex("""Msdk5(Keys|Camera|ReadingsKt)?(\$.*)?\.class""")
        assertEquals(emptyList(), files.map { it.name }.filterNot(isThinLayer::matches))
    }

    @Test
    fun `a missing member would be found`() {
        val absent = listOf(
            Reference("dji/v5/manager/KeyManager", "getInstance ()V", isField = false),
            Reference("dji/v5/manager/Absent", null, isField = false),
            Reference("dji/sdk/keyvalue/key/FlightControllerKey", "KeyAbsent I", isField = true),
        )
        assertEquals(emptyList(), absent.filter(linkage::exists))
    }
}
