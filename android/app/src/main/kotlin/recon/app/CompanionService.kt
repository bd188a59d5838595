package recon.app

import android.app.Notification
import android.app.NotificationChannel
import android.app.NotificationManager
import android.app.PendingIntent
import android.app.Service
import android.content.Context
import android.content.Intent
import android.content.pm.ServiceInfo
import android.net.wifi.WifiManager
import android.os.Build
import android.os.IBinder
import android.os.PowerManager
import recon.errors.ReconError

/**
 * Keeps the companion running while it is connected: in the foreground for Android, the processor and the
 * Wi-Fi awake. After Android has ended the process it is started again, connects, and leaves released
 * control released.
 */
class CompanionService : Service() {
    private val host by lazy { reconApplication.host }
    private val phone by lazy { PhoneMonitor(this, host::report) }
    private val wakeLock by lazy {
        getSystemService(PowerManager::class.java).newWakeLock(PowerManager.PARTIAL_WAKE_LOCK, "recon:companion")
    }
    private val wifiLock by lazy {
        // Newer modes have no effect with the screen off.
        @Suppress("DEPRECATION")
        val mode = WifiManager.WIFI_MODE_FULL_HIGH_PERF
        applicationContext.getSystemService(WifiManager::class.java).createWifiLock(mode, "recon:companion")
    }
    private val update: () -> Unit = ::updateNotification
    private var isStarted = false
    private var shownText = ""

    override fun onBind(intent: Intent): IBinder? = null

    override fun onStartCommand(intent: Intent?, flags: Int, startId: Int): Int {
        if (intent?.action == RELEASE) host.releaseControl()
        if (isStarted) return START_STICKY
        try {
            showInForeground()
            host.start()
        } catch (error: ReconError) {
            // The stored address is no longer valid.
            reconApplication.log.add("error", error.message)
            stopSelf()
            return START_NOT_STICKY
        } catch (error: IllegalStateException) {
            // Android does not let every restarted process into the foreground.
            reconApplication.log.add("error", "Android refused to run in the foreground: ${error.message}")
            stopSelf()
            return START_NOT_STICKY
        }
        isStarted = true
        wakeLock.acquire(LONGEST_DAY_MS)
        wifiLock.acquire()
        phone.start()
        host.observe(update)
        return START_STICKY
    }

    override fun onDestroy() {
        if (!isStarted) return
        host.unobserve(update)
        phone.stop()
        wifiLock.release()
        if (wakeLock.isHeld) wakeLock.release()
        host.stop()
    }

    @NewerAndroid
    private fun showInForeground() {
        val channel = NotificationChannel(CHANNEL, getString(R.string.channel), NotificationManager.IMPORTANCE_LOW)
        getSystemService(NotificationManager::class.java).createNotificationChannel(channel)
        val notification = notification(text())
        if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.Q) {
            startForeground(NOTIFICATION_ID, notification, ServiceInfo.FOREGROUND_SERVICE_TYPE_CONNECTED_DEVICE)
        } else {
            startForeground(NOTIFICATION_ID, notification)
        }
    }

    private fun updateNotification() {
        val text = text()
        if (text == shownText) return
        getSystemService(NotificationManager::class.java).notify(NOTIFICATION_ID, notification(text))
    }

    private fun text(): String {
        val status = host.status ?: return getString(R.string.channel)
        return "${status.link.words}. ${getString(R.string.control)}: ${status.control.words}"
    }

    private fun notification(text: String): Notification {
        shownText = text
        val screen = Intent(this, MainActivity::class.java)
        val release = Intent(this, CompanionService::class.java).setAction(RELEASE)
        val builder = Notification.Builder(this, CHANNEL)
            .setSmallIcon(R.drawable.notification)
            .setContentTitle(getString(R.string.app_name))
            .setContentText(text)
            .setOngoing(true)
            .setOnlyAlertOnce(true)
            .setContentIntent(PendingIntent.getActivity(this, 0, screen, PendingIntent.FLAG_IMMUTABLE))
        if (!host.isReleased) {
            val pending = PendingIntent.getService(this, 1, release, PendingIntent.FLAG_IMMUTABLE)
            builder.addAction(Notification.Action.Builder(null, getString(R.string.release), pending).build())
        }
        return builder.build()
    }

    companion object {
        private const val RELEASE = "recon.app.RELEASE"
        private const val CHANNEL = "connection"
        private const val NOTIFICATION_ID = 1

        /** The longest that a wake lock is held should nothing release it. */
        private const val LONGEST_DAY_MS = 16L * 3_600_000

        fun start(context: Context) {
            context.startForegroundService(Intent(context, CompanionService::class.java))
        }

        fun stop(context: Context) {
            context.stopService(Intent(context, CompanionService::class.java))
        }
    }
}
