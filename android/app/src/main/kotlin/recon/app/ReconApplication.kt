package recon.app

import android.app.Application
import android.content.Context
import android.net.ConnectivityManager
import android.os.Handler
import android.os.Looper
import java.io.File
import java.time.Instant
import java.util.concurrent.Executors

/** What the process has one of. A build with another kind of aircraft overrides [aircraftSource]. */
open class ReconApplication : Application() {
    val settings by lazy { AppSettings(getSharedPreferences("settings", Context.MODE_PRIVATE)) }
    val source by lazy { aircraftSource() }
    val log by lazy { FlightLog(File(filesDir, "logs"), Executors.newSingleThreadExecutor(), Instant::now) }
    val host by lazy {
        CompanionHost(
            settings,
            source,
            log,
            SpokenWarnings(TextToSpeechVoice(this)),
            LocalNetwork(getSystemService(ConnectivityManager::class.java))::tune,
            Executors.newSingleThreadExecutor(),
            Handler(Looper.getMainLooper()),
            System::currentTimeMillis,
        )
    }

    protected open fun aircraftSource(): AircraftSource = SimulatedSource(settings.simulatedSerial)
}

val Context.reconApplication: ReconApplication get() = applicationContext as ReconApplication
