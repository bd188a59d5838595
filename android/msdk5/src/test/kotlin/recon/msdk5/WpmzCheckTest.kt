package recon.msdk5

import java.io.File
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertIs

/** DJI's checker as it answers in public threads. */
class FakeChecker {
    private var isReady = false

    @Suppress("unused")
    fun init(context: Any) {
        isReady = context == "context"
    }

    @Suppress("unused")
    fun checkValidation(path: String): Any? {
        check(isReady) { "not initialised" }
        return when (path) {
            "silent" -> null
            "raising" -> throw IllegalArgumentException("no native library")
            else -> path
        }
    }

    companion object {
        @JvmStatic
        fun getInstance() = FakeChecker()
    }
}

class WpmzCheckTest {
    @Test
    fun `DJI's answers are read as they are printed`() {
        assertEquals(FileCheck.Passed, checked("""{"value" : [ ]}"""))
        assertEquals(FileCheck.Passed, checked("""{"value":[0]}"""))
        assertEquals(FileCheck.Faulty(listOf(-10)), checked("""{"value":[-10]}"""))
        assertEquals(FileCheck.Faulty(listOf(-12, 261)), checked("""{"value":[0,-12,261]}"""))
    }

    @Test
    fun `a checker that is not there, or fails, is no fault of the file`() {
        assertEquals(FileCheck.Absent("this build lacks it"), WpmzCheck("context").of(File("a.kmz")))
        for ((path, words) in mapOf("silent" to "no answer", "odd" to "not understood: odd", "raising" to "native")) {
            val absent = assertIs<FileCheck.Absent>(checked(path))
            assert(words in absent.reason) { absent.reason }
        }
        assertIs<FileCheck.Absent>(WpmzCheck("other", FakeChecker::class.java.name).of(File("[]")))
        assertIs<FileCheck.Absent>(WpmzCheck("context", "java.lang.String").of(File("[]")))
    }

    private fun checked(path: String) = WpmzCheck("context", FakeChecker::class.java.name).of(File(path))
}
