package recon.msdk5

import java.io.File
import java.lang.reflect.InvocationTargetException
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertFailsWith

/** The thin layer as the JVM links it: verified against DJI's classes, and its first call reaches them. */
class StubbedMsdk5Test {
    private val loader = StubLoader()

    @Test
    fun `the thin layer passes the JVM's verifier, all of its classes`() {
        val files = File("target/classes/recon/msdk5").list().orEmpty()
            .filter { it.startsWith("Msdk5") && it.endsWith(".class") }
        val names = files.map { "recon.msdk5." + it.removeSuffix(".class") }
        val loaded = names.map { Class.forName(it, true, loader) }
        assertEquals(loader, loaded.first { it.simpleName == "Msdk5" }.classLoader)
        loaded.forEach { it.declaredMethods.size }
    }

    @Test
    fun `its first call is one to DJI's SDK`() {
        val constructor = Class.forName("recon.msdk5.Msdk5", true, loader).constructors.single()
        val clock: () -> Long = { 0 }
        val check: (File) -> FileCheck = { FileCheck.Passed }
        val raised = assertFailsWith<InvocationTargetException> { constructor.newInstance(File("."), check, clock) }
        assertEquals(STUB, raised.targetException.message)
        assertEquals("dji.v5.manager.KeyManager", raised.targetException.stackTrace.first().className)
    }
}
