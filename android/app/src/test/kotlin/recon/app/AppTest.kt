package recon.app

import android.app.Activity
import android.app.AlertDialog
import android.app.Service
import android.content.Intent
import android.net.Uri
import android.os.Looper
import android.view.View
import android.view.WindowManager
import android.widget.Button
import android.widget.EditText
import android.widget.Spinner
import android.widget.TextView
import org.junit.After
import org.junit.Test
import org.junit.runner.RunWith
import org.robolectric.Robolectric
import org.robolectric.RobolectricTestRunner
import org.robolectric.RuntimeEnvironment
import org.robolectric.Shadows.shadowOf
import org.robolectric.android.controller.ActivityController
import org.robolectric.shadows.ShadowAlertDialog
import org.robolectric.shadows.ShadowPowerManager
import recon.aircraft.AircraftCommand
import recon.aircraft.AltitudeReference
import recon.session.LinkLossAction
import recon.wire.Acknowledgment
import recon.wire.CoreTelemetry
import recon.wire.EmergencyCommand
import recon.wire.ExtendedTelemetry
import recon.wire.VirtualStickCommand
import java.io.FileInputStream
import java.io.FileNotFoundException
import kotlin.test.assertEquals
import kotlin.test.assertFalse
import kotlin.test.assertNotNull
import kotlin.test.assertNull
import kotlin.test.assertTrue

/** The screen, its service and a companion app, against a station on a real socket. */
@RunWith(RobolectricTestRunner::class)
class AppTest {
    private val application = RuntimeEnvironment.getApplication() as ReconApplication
    private val station = Station()
    private val screens = mutableListOf<ActivityController<MainActivity>>()
    private var service: Service? = null

    @After
    fun close() {
        application.host.stop()
        screens.forEach { it.close() }
        station.close()
    }

    @Test
    fun `it states on its first screen that it lacks DJI's runtime`() {
        val screen = open()
        assertTrue("It lacks DJI's runtime: no real drone can be connected." in screen.text(R.id.note))
        assertEquals(View.VISIBLE, screen.view(R.id.note).visibility)
        assertFalse(screen.view(R.id.status).isShown)
    }

    @Test
    fun `a typed address connects, and the rows tell what happens`() {
        val screen = connect()
        await { screen.words(R.id.link) == "Connected" }
        assertEquals("Link to ${station.address}", screen.label(R.id.link))
        assertEquals("Station", screen.words(R.id.control))
        assertEquals("Above takeoff", screen.words(R.id.altitude_reference))
        assertTrue(screen.words(R.id.aircraft).endsWith("on the ground, battery 100 %"))
        station.send(EmergencyCommand(EmergencyCommand.LAND))
        await { screen.words(R.id.last_order) == "Land" }
        assertTrue(screen.window.attributes.flags and WindowManager.LayoutParams.FLAG_KEEP_SCREEN_ON != 0)
        assertFalse(screen.view(R.id.setup).isShown)
    }

    @Test
    fun `an invalid address is refused with a sentence`() {
        val screen = open()
        screen.findViewById<EditText>(R.id.address).setText("http://nowhere")
        screen.press(R.id.connect)
        assertTrue(screen.text(R.id.address_problem).startsWith("Station address must be HOST or HOST:PORT"))
        assertNull(shadowOf(application).nextStartedService)
    }

    @Test
    fun `release reaches the station, holds without a link, and ends when the person allows it`() {
        val screen = connect()
        station.next { it is ExtendedTelemetry }
        screen.press(R.id.release)
        station.message("Control released to the pilot")
        await { screen.words(R.id.control).startsWith("Pilot: released") }
        assertFalse(screen.view(R.id.release).isShown)
        screen.press(R.id.allow)
        answerDialog()
        station.message("The station may command again")
        assertTrue(screen.view(R.id.release).isShown)
    }

    @Test
    fun `control released while nothing is connected is known to the station from the start`() {
        open().press(R.id.release)
        connect()
        station.message("control released to the pilot")
    }

    @Test
    fun `a process that Android ended comes back connected, with control still released`() {
        application.settings.address = station.address
        application.settings.isReleased = true
        val restarted = Robolectric.buildService(CompanionService::class.java).create().get()
        assertEquals(Service.START_STICKY, restarted.onStartCommand(null, 0, 1))
        station.accept()
        station.message("control released to the pilot")
        restarted.onDestroy()
    }

    @Test
    fun `the service is in the foreground, keeps the processor awake, and lets it sleep again`() {
        connect()
        val shown = shadowOf(service)
        assertNotNull(shown.lastForegroundNotification)
        val lock = ShadowPowerManager.getLatestWakeLock()
        assertTrue(lock.isHeld)
        service!!.onDestroy()
        assertFalse(lock.isHeld)
        assertTrue(station.isAtEnd())
    }

    @Test
    fun `control can be released from the notification`() {
        connect()
        station.next { it is ExtendedTelemetry }
        val action = shadowOf(service).lastForegroundNotification.actions.single()
        assertEquals("Release control", action.title)
        service!!.onStartCommand(shadowOf(action.actionIntent).savedIntent, 0, 2)
        station.message("Control released to the pilot")
    }

    @Test
    fun `the connection and the rows survive a rotation and the background`() {
        val screen = connect()
        await { screen.words(R.id.link) == "Connected" }
        val controller = screens.single()
        RuntimeEnvironment.setQualifiers("+land")
        controller.recreate()
        val turned = controller.get()
        assertEquals("Connected", turned.words(R.id.link))
        controller.pause().stop()
        station.send(EmergencyCommand(EmergencyCommand.LAND))
        station.next { it is Acknowledgment }
        controller.start().resume()
        await { turned.words(R.id.last_order) == "Land" }
    }

    @Test
    fun `it connects again after the station closed the link, and shows so meanwhile`() {
        val screen = connect()
        await { screen.words(R.id.link) == "Connected" }
        station.drop()
        await { screen.words(R.id.link) == "No station" }
        station.accept()
        await { screen.words(R.id.link) == "Connected" }
        assertTrue("warning: Link to the station lost" in screen.text(R.id.messages))
    }

    @Test
    fun `a station that floods the app with orders is answered, and the screen keeps the newest messages`() {
        val screen = connect()
        repeat(2_000) { station.send(EmergencyCommand(it % 200 + 3)) }
        station.send(EmergencyCommand(EmergencyCommand.HOVER))
        station.message("On the ground: hover is ignored")
        await { "hover is ignored" in screen.text(R.id.messages) }
        assertTrue(application.host.messages.size <= 20)
    }

    @Test
    fun `disconnecting asks first while the aircraft flies for the station`() {
        val screen = connect()
        station.next { it is ExtendedTelemetry }
        fly()
        await { screen.words(R.id.control) == "Station: virtual stick" }
        screen.press(R.id.disconnect)
        assertNull(shadowOf(application).nextStoppedService)
        answerDialog()
        assertEquals(CompanionService::class.java.name, shadowOf(application).nextStoppedService.component!!.className)
        service!!.onDestroy()
        assertTrue(station.isAtEnd())
    }

    @Test
    fun `a link fills in the address and does not connect`() {
        val screen = open(Intent(Intent.ACTION_VIEW, Uri.parse("recon://192.168.8.20:3005")))
        assertEquals("192.168.8.20:3005", screen.text(R.id.address))
        assertNull(shadowOf(application).nextStartedService)
        val hostile = open(Intent(Intent.ACTION_VIEW, Uri.parse("recon://a b/../%00")))
        assertTrue(hostile.text(R.id.address_problem).startsWith("Station address must be"))
    }

    @Test
    fun `a scanned code fills in the address`() {
        val screen = open()
        screen.press(R.id.scan)
        val started = shadowOf(screen).nextStartedActivityForResult
        assertEquals(ScanActivity::class.java.name, started.intent.component!!.className)
        val result = Intent().setData(Uri.parse("recon://10.0.0.5:3001"))
        shadowOf(screen).receiveResult(started.intent, Activity.RESULT_OK, result)
        assertEquals("10.0.0.5:3001", screen.text(R.id.address))
    }

    @Test
    fun `settings are kept, and reported to the station`() {
        val screen = open()
        screen.findViewById<Spinner>(R.id.waypoint_altitude).setSelection(AltitudeReference.WGS84.ordinal)
        screen.findViewById<Spinner>(R.id.lost_link).setSelection(LinkLossAction.RETURN.ordinal)
        idle()
        assertEquals(AltitudeReference.WGS84, application.settings.altitudeReference)
        connect()
        station.message("waypoint altitude wgs84, mission on lost link return, hover on the ground ignore")
    }

    @Test
    fun `the log of a connection can be shared, and nothing else can be read`() {
        val screen = connect()
        await { screen.words(R.id.link) == "Connected" }
        await { application.log.newest()?.readText().orEmpty().contains("Connected to the station") }
        screen.press(R.id.share)
        val chooser = shadowOf(screen).nextStartedActivity
        @Suppress("DEPRECATION")
        val send = chooser.getParcelableExtra<Intent>(Intent.EXTRA_INTENT)!!
        @Suppress("DEPRECATION")
        val uri = send.getParcelableExtra<Uri>(Intent.EXTRA_STREAM)!!
        val provider = Robolectric.setupContentProvider(LogProvider::class.java)
        val file = provider.openFile(uri, "rw")
        val text = file.use { FileInputStream(it.fileDescriptor).bufferedReader().readText() }
        assertTrue("station ${station.address}" in text)
        for (path in listOf("settings.xml", "..%2Fsettings.xml", "")) {
            val other = Uri.parse("content://recon.app.log/$path")
            assertTrue(runCatching { provider.openFile(other, "r") }.exceptionOrNull() is FileNotFoundException)
        }
    }

    private fun open(intent: Intent? = null): MainActivity {
        val controller = Robolectric.buildActivity(MainActivity::class.java, intent)
        screens += controller
        return controller.setup().get()
    }

    /** Types the station's address, presses Connect, and starts the service as Android would. */
    private fun connect(): MainActivity {
        val screen = open()
        screen.findViewById<EditText>(R.id.address).setText(station.address)
        screen.press(R.id.connect)
        val started = shadowOf(application).nextStartedService
        service = Robolectric.buildService(CompanionService::class.java, started).create().startCommand(0, 1).get()
        station.accept()
        idle()
        return screen
    }

    /** Takes off as the pilot would, and has the station steer. */
    private fun fly() {
        application.source.open { _, _ -> }.execute(AircraftCommand.TakeOff) {}
        station.next { it is CoreTelemetry && it.isFlying == 1 }
        station.send(VirtualStickCommand(0, 90f, 0f, 0f, 5f, 60f))
    }

    private fun answerDialog() {
        val dialog = ShadowAlertDialog.getLatestDialog() as AlertDialog
        dialog.getButton(AlertDialog.BUTTON_POSITIVE).performClick()
        idle()
    }

    private fun await(isSo: () -> Boolean) {
        val endNs = System.nanoTime() + PATIENCE_MS * 1_000_000L
        while (true) {
            idle()
            if (isSo()) return
            check(System.nanoTime() < endNs) { "not seen within $PATIENCE_MS ms" }
            Thread.sleep(5)
        }
    }

    private fun idle() = shadowOf(Looper.getMainLooper()).idle()

    private fun MainActivity.view(id: Int): View = findViewById(id)

    private fun MainActivity.text(id: Int): String = findViewById<TextView>(id).text.toString()

    private fun MainActivity.words(row: Int): String = view(row).findViewById<TextView>(R.id.row_words).text.toString()

    private fun MainActivity.label(row: Int): String = view(row).findViewById<TextView>(R.id.row_label).text.toString()

    private fun MainActivity.press(id: Int) {
        val button = findViewById<Button>(id)
        assertTrue(button.isShown && button.isEnabled, "button is not there")
        button.performClick()
        idle()
    }
}
