package recon.app.dji

import recon.msdk5.Linkage
import java.io.File
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertFalse
import kotlin.test.assertTrue

/** The Gradle project, which cannot be built here: its files, its versions, and what its sources refer to. */
class StudioTest {
    private val gradle = File("build.gradle.kts").readText()
    private val properties = File("../pom.xml").readText()

    @Test
    fun `its files are these, and no more`() {
        val generated = setOf("target", "build", ".gradle", ".idea", "local.properties", ".jqwik-database")
        val files = File(".").walk().onEnter { it.name !in generated }
        val names = files.filter { it.isFile && it.name !in generated }.map { it.invariantSeparatorsPath }
        val expected = listOf(
            ".gitignore", "build.gradle.kts", "gradle.properties", "gradle/wrapper/gradle-wrapper.properties",
            "pom.xml", "settings.gradle.kts", "src/dji/AndroidManifest.xml", "src/dji/kotlin/recon/app/dji/DjiApplication.kt",
            "src/dji/kotlin/recon/app/dji/DjiSource.kt", "src/dji/kotlin/recon/app/dji/SdkRegistration.kt",
            "src/dji/res/xml/accessory_filter.xml", "src/test/kotlin/recon/app/dji/DjiSourceTest.kt",
            "src/test/kotlin/recon/app/dji/StudioTest.kt",
        )
        assertEquals(expected, names.map { it.removePrefix("./") }.sorted().toList())
    }

    @Test
    fun `its versions are Maven's`() {
        assertEquals(maven("dji.version"), version("com.dji:dji-sdk-v5-aircraft"))
        assertEquals(maven("dji.version"), version("com.dji:dji-sdk-v5-aircraft-provided"))
        assertEquals(maven("dji.version"), version("com.dji:dji-sdk-v5-networkImp"))
        assertEquals(maven("zxing.version"), version("com.google.zxing:core"))
        assertEquals(maven("kotlin.version"), found(Regex("""kotlin\.android"\) version "([^"]+)""""), gradle))
        assertEquals(maven("android.sdk"), found(Regex("compileSdk = (\\d+)"), gradle))
        assertEquals(maven("android.sdk"), found(Regex("targetSdk = (\\d+)"), gradle))
        assertEquals(maven("android.min.sdk"), found(Regex("minSdk = (\\d+)"), gradle))
        assertEquals(found(Regex("<version>([^<]+)"), properties), found(Regex("versionName = \"([^\"]+)"), gradle))
    }

    @Test
    fun `the sources that it names exist`() {
        val paths = Regex("\"(\\.\\./[^\"]+)\"").findAll(gradle).map { it.groupValues[1] }.toList()
        assertEquals(5, paths.size)
        assertEquals(emptyList(), paths.filterNot { File(it).exists() })
    }

    @Test
    fun `it holds no key, and git ignores the file that does`() {
        assertTrue("/local.properties" in File(".gitignore").readLines())
        assertFalse(Regex("[0-9a-f]{24}").containsMatchIn(gradle))
        assertTrue("\${djiApiKey}" in File("src/dji/AndroidManifest.xml").readText())
    }

    @Test
    fun `nothing that its sources refer to is missing in DJI's signatures or in Android`() {
        val linkage = Linkage()
        val all = linkage.referencesOf(File("target/classes")).values.flatten().toSet()
        println("${all.size} references of the app's part that calls DJI, checked")
        assertTrue(all.count { it.owner.startsWith("dji/") } >= 8, all.toString())
        assertEquals(emptyList(), all.filterNot(linkage::exists).map { it.toString() })
    }

    private fun maven(property: String) = found(Regex("<${Regex.escape(property)}>([^<]+)<"), properties)

    private fun version(artifact: String) = found(Regex("\"${Regex.escape(artifact)}:([^\"]+)\""), gradle)

    private fun found(pattern: Regex, text: String): String =
        checkNotNull(pattern.find(text)) { "no $pattern" }.groupValues[1]
}
