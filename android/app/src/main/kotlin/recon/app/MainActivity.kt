package recon.app

import android.Manifest
import android.app.Activity
import android.app.AlertDialog
import android.content.Intent
import android.content.pm.PackageManager
import android.net.nsd.NsdManager
import android.os.Build
import android.os.Bundle
import android.view.WindowManager
import android.widget.Toast
import recon.link.AddressError
import recon.link.StationAddress

/**
 * The one screen. It holds nothing of its own: each new one, after a rotation for example, shows the
 * state of [CompanionHost].
 */
class MainActivity : Activity() {
    private val host by lazy { reconApplication.host }
    private val settings by lazy { reconApplication.settings }
    private val update: () -> Unit = ::show
    private val finder by lazy {
        StationFinder(getSystemService(NsdManager::class.java)) { found ->
            runOnUiThread { screen.showStations(found) { fillIn(it.toString()) } }
        }
    }
    private lateinit var screen: Screen

    override fun onCreate(savedInstanceState: Bundle?) {
        super.onCreate(savedInstanceState)
        setContentView(R.layout.main)
        screen = Screen(this)
        screen.showNote(reconApplication.source.note)
        screen.addressView.setText(settings.address)
        Choices(this, settings)
        screen.onConnect(::connect)
        screen.onScan { startActivityForResult(Intent(this, ScanActivity::class.java), SCAN) }
        screen.onRelease { host.releaseControl() }
        screen.onAllow { ask(R.string.allow_question, R.string.allow) { host.allowControl() } }
        screen.onDisconnect(::disconnect)
        screen.onShare(::shareLog)
        if (savedInstanceState == null) takeLink(intent)
    }

    override fun onNewIntent(intent: Intent) {
        super.onNewIntent(intent)
        takeLink(intent)
    }

    override fun onStart() {
        super.onStart()
        host.observe(update)
        show()
    }

    override fun onStop() {
        super.onStop()
        host.unobserve(update)
        finder.stop()
    }

    @Deprecated("Deprecated in Java")
    override fun onActivityResult(requestCode: Int, resultCode: Int, data: Intent?) {
        if (requestCode == SCAN && resultCode == RESULT_OK) data?.dataString?.let(::fillIn)
    }

    /** A link fills in the address; only the person connects. */
    private fun takeLink(intent: Intent) {
        if (intent.action == Intent.ACTION_VIEW && host.station == null) intent.dataString?.let(::fillIn)
    }

    private fun fillIn(text: String) {
        try {
            screen.addressView.setText(StationAddress.parse(text).toString())
            screen.showAddressProblem(null)
        } catch (error: AddressError) {
            screen.showAddressProblem(error.message)
        }
    }

    private fun connect() {
        val text = screen.addressView.text.toString()
        try {
            StationAddress.parse(text)
        } catch (error: AddressError) {
            return screen.showAddressProblem(error.message)
        }
        screen.showAddressProblem(null)
        settings.address = text.trim()
        askForNotifications()
        CompanionService.start(this)
    }

    private fun disconnect() {
        if (host.status?.isFlyingForStation != true) return CompanionService.stop(this)
        ask(R.string.disconnect_question, R.string.disconnect) { CompanionService.stop(this) }
    }

    /** The service runs without the notification too; it shows that it runs. */
    private fun askForNotifications() {
        if (Build.VERSION.SDK_INT < Build.VERSION_CODES.TIRAMISU) return
        val permission = Manifest.permission.POST_NOTIFICATIONS
        if (checkSelfPermission(permission) == PackageManager.PERMISSION_GRANTED) return
        requestPermissions(arrayOf(permission), 0)
    }

    private fun ask(question: Int, action: Int, confirmed: () -> Unit) {
        AlertDialog.Builder(this)
            .setMessage(question)
            .setPositiveButton(action) { _, _ -> confirmed() }
            .setNegativeButton(R.string.cancel, null)
            .show()
    }

    private fun shareLog() {
        val log = reconApplication.log.newest()
        if (log == null) {
            Toast.makeText(this, R.string.no_log, Toast.LENGTH_LONG).show()
        } else {
            startActivity(LogProvider.sharing(log, getString(R.string.log_subject)))
        }
    }

    private fun show() {
        val isRunning = host.station != null
        screen.show(host)
        if (isRunning) finder.stop() else finder.start()
        // In the air a pilot has no time to switch a dark screen on.
        if (isRunning) window.addFlags(WindowManager.LayoutParams.FLAG_KEEP_SCREEN_ON)
        else window.clearFlags(WindowManager.LayoutParams.FLAG_KEEP_SCREEN_ON)
    }

    private companion object {
        const val SCAN = 1
    }
}
