package recon.app

import android.graphics.Bitmap
import android.graphics.Canvas
import android.graphics.Color
import android.graphics.drawable.ColorDrawable
import android.os.Looper
import android.view.View
import android.view.ViewGroup
import android.widget.Button
import android.widget.Spinner
import android.widget.TextView
import org.junit.After
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.ParameterizedRobolectricTestRunner
import org.robolectric.ParameterizedRobolectricTestRunner.Parameters
import org.robolectric.Robolectric
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import recon.link.StationAddress
import java.io.File
import kotlin.math.pow
import kotlin.test.assertEquals
import kotlin.test.assertTrue

/** The screen as it is drawn: sizes of what is touched, contrasts, nothing cut off; pictures in target/screens. */
@RunWith(ParameterizedRobolectricTestRunner::class)
class ScreenTest(private val name: String, private val qualifiers: String) {
    private val controller by lazy {
        RuntimeEnvironment.setQualifiers(qualifiers)
        Robolectric.buildActivity(MainActivity::class.java).setup()
    }
    private val screen by lazy { controller.get() }
    private val host by lazy { (RuntimeEnvironment.getApplication() as ReconApplication).host }
    private val station = Station()

    @After
    fun close() {
        host.stop()
        controller.close()
        station.close()
    }

    @Test
    fun `before a connection`() {
        Screen(screen).showStations(listOf(FoundStation("Field laptop", StationAddress("192.168.8.20", 3001)))) {}
        check("setup")
    }

    @Test
    fun `connected, and after the pilot took control`() {
        connect()
        check("connected")
        host.releaseControl()
        await { host.status?.isReleased == true }
        check("released")
    }

    @Test
    fun `without a station`() {
        connect()
        station.close()
        await { host.status?.link?.words == "No station" }
        check("lost")
    }

    private fun connect() {
        screen.reconApplication.settings.address = station.address
        host.start()
        station.accept()
        await { host.status?.link?.words == "Connected" && host.status?.aircraft?.level == Level.NORMAL }
    }

    private fun check(state: String) {
        shadowOf(Looper.getMainLooper()).idle()
        val root = screen.window.decorView
        draw(root, "$name-$state")
        val shown = descendants(root).filter { it.isShown }
        assertEquals(emptyList(), shown.filter { isTouched(it) && !isLargeEnough(it) }.map(::nameOf))
        val texts = shown.filterIsInstance<TextView>().filter { it.text.isNotEmpty() && it.id != R.id.address }
        assertTrue(texts.size > 8, "${texts.size} texts")
        assertEquals(emptyList(), texts.filter { contrastOf(it) < 7.0 }.map(::nameOf))
        assertEquals(emptyList(), texts.filter(::isCutOff).map(::nameOf))
    }

    private fun isTouched(view: View) = view is Button || view is Spinner || view.id == R.id.address

    private fun isLargeEnough(view: View): Boolean {
        val density = screen.resources.displayMetrics.density
        return view.width >= 48 * density && view.height >= 48 * density
    }

    private fun isCutOff(view: TextView): Boolean {
        val layout = view.layout ?: return true
        return (0 until layout.lineCount).any { layout.getEllipsisCount(it) > 0 } ||
            layout.height > view.height - view.compoundPaddingTop - view.compoundPaddingBottom
    }

    private fun contrastOf(view: TextView): Double {
        val (lighter, darker) = listOf(luminance(view.currentTextColor), luminance(backgroundOf(view)))
            .sortedDescending()
        return (lighter + 0.05) / (darker + 0.05)
    }

    private fun backgroundOf(view: View): Int {
        val own = view.backgroundTintList?.defaultColor ?: (view.background as? ColorDrawable)?.color
        val parent = view.parent
        return own ?: if (parent is View) backgroundOf(parent) else screen.getColor(R.color.background)
    }

    /** Relative luminance as WCAG 2 defines it. */
    private fun luminance(color: Int): Double {
        val (red, green, blue) = listOf(Color.red(color), Color.green(color), Color.blue(color)).map {
            val part = it / 255.0
            if (part <= 0.04045) part / 12.92 else ((part + 0.055) / 1.055).pow(2.4)
        }
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    private fun draw(root: View, file: String) {
        val bitmap = Bitmap.createBitmap(root.width, root.height, Bitmap.Config.ARGB_8888)
        root.draw(Canvas(bitmap))
        val folder = File("target/screens").apply { mkdirs() }
        File(folder, "$file.png").outputStream().use { bitmap.compress(Bitmap.CompressFormat.PNG, 100, it) }
        val corners = listOf(bitmap.getPixel(0, 0), bitmap.getPixel(root.width - 1, root.height - 1))
        assertEquals(List(2) { screen.getColor(R.color.background) }, corners)
    }

    private fun descendants(view: View): List<View> =
        listOf(view) + (view as? ViewGroup)?.let { group -> List(group.childCount) { group.getChildAt(it) } }.orEmpty()
            .flatMap(::descendants)

    private fun nameOf(view: View): String = "$name: ${(view as? TextView)?.text} ${view.width} x ${view.height}"

    private fun await(isSo: () -> Boolean) {
        val endNs = System.nanoTime() + PATIENCE_MS * 1_000_000L
        while (!isSo()) {
            check(System.nanoTime() < endNs) { "not seen within $PATIENCE_MS ms" }
            Thread.sleep(5)
        }
    }

    companion object {
        @JvmStatic
        @Parameters(name = "{0}")
        fun screens() = listOf(
            arrayOf("light", "w411dp-h891dp-port-notnight-420dpi"),
            arrayOf("dark", "w411dp-h891dp-port-night-420dpi"),
            arrayOf("small", "w320dp-h533dp-port-notnight-240dpi"),
            // As on a controller with a screen.
            arrayOf("landscape", "w960dp-h540dp-land-notnight-hdpi"),
        )
    }
}
