package recon.msdk5

import java.io.File
import java.lang.reflect.InvocationTargetException

/** What DJI's own checker says of a mission file. */
sealed interface FileCheck {
    data object Passed : FileCheck

    /** DJI's numbers of what is wrong. */
    data class Faulty(val numbers: List<Int>) : FileCheck

    /** There was no check; [reason] completes a sentence. */
    data class Absent(val reason: String) : FileCheck
}

/** DJI's numbers of faults in a mission file, as its support has published them. */
private val FAULTS = mapOf(
    -1 to "no file",
    -2 to "the file cannot be parsed",
    -3 to "number of waylines",
    -4 to "number of waypoints",
    -5 to "action on a lost controller",
    -6 to "speed of a waypoint",
    -7 to "speed between takeoff and route",
    -8 to "distance of a turn",
    -9 to "mode of a turn",
    -10 to "heading mode",
    -11 to "position of a waypoint",
    -12 to "height of a waypoint",
    -14 to "speed between takeoff and route",
    -15 to "safe takeoff height",
    -16 to "index of a waypoint",
    -26 to "type of an action",
    -30 to "range of the gimbal",
    -32 to "trigger of an action",
    -33 to "seconds between photos",
    -34 to "metres between photos",
    261 to "height mode",
    262 to "mode of the flight to the first waypoint",
)

/** The faults in words, each with DJI's number. */
internal fun faultWords(numbers: List<Int>): String =
    numbers.take(MOST_SHOWN).joinToString(", ") { "${FAULTS[it] ?: "unknown fault"} ($it)" }

private const val MOST_SHOWN = 5

/**
 * DJI's checker of mission files, `WPMZManager.checkValidation`, called by its name: it is a library of
 * DJI's beside the SDK, which a build may lack. [context] is Android's.
 */
class WpmzCheck(private val context: Any, private val className: String = "com.dji.wpmzsdk.manager.WPMZManager") {

    /** Checks a file; never raises. */
    fun of(file: File): FileCheck = try {
        val manager = manager()
        answered(manager.javaClass.getMethod("checkValidation", String::class.java).invoke(manager, file.path))
    } catch (error: ClassNotFoundException) {
        FileCheck.Absent("this build lacks it")
    } catch (error: ReflectiveOperationException) {
        FileCheck.Absent("it failed: ${reasonOf(error)}")
    } catch (error: LinkageError) {
        FileCheck.Absent("it failed: ${reasonOf(error)}")
    }

    private fun manager(): Any {
        val type = Class.forName(className)
        val manager = type.getMethod("getInstance").invoke(null)
        type.methods.firstOrNull { it.name == "init" && it.parameterCount == 1 }?.invoke(manager, context)
        return manager
    }

    /** The answer is a list of numbers in an object of DJI's, which prints it: `{"value":[-10]}`; 0 is no fault. */
    private fun answered(answer: Any?): FileCheck {
        val text = answer?.toString() ?: return FileCheck.Absent("it gave no answer")
        val numbers = NUMBER.findAll(text.substringAfter('[')).map { it.value.toInt() }.filter { it != 0 }.toList()
        return when {
            '[' !in text -> FileCheck.Absent("its answer was not understood: ${text.take(LONGEST_SHOWN)}")
            numbers.isEmpty() -> FileCheck.Passed
            else -> FileCheck.Faulty(numbers)
        }
    }

    private fun reasonOf(error: Throwable): String =
        (if (error is InvocationTargetException) error.targetException else error).toString().take(LONGEST_SHOWN)

    private companion object {
        val NUMBER = Regex("""-?\d{1,6}""")
        const val LONGEST_SHOWN = 80
    }
}
