package recon.app

import android.app.Application
import android.content.Context
import android.net.ConnectivityManager
import android.os.Handler
import android.os.Looper
import java.io.File
import java.time.Instant
import java.util.concurrent.ArrayBlockingQueue
import java.util.concurrent.Executor
import java.util.concurrent.Executors
import java.util.concurrent.ThreadPoolExecutor
import java.util.concurrent.TimeUnit

/** What the process has one of. A build with another kind of aircraft overrides [aircraftSource]. */
open class ReconApplication : Application() {
    val settings by lazy { AppSettings(getSharedPreferences("settings", Context.MODE_PRIVATE)) }
    val source by lazy { aircraftSource() }
    val log by lazy { FlightLog(File(filesDir, "logs"), storageThread(), Instant::now) }
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

    /** Under a flood of messages lines are dropped: they must not fill the memory. */
    private fun storageThread(): Executor {
        val waiting = ArrayBlockingQueue<Runnable>(MOST_WAITING_LINES)
        return ThreadPoolExecutor(1, 1, 0, TimeUnit.SECONDS, waiting, ThreadPoolExecutor.DiscardPolicy())
    }

    protected open fun aircraftSource(): AircraftSource = SimulatedSource(settings.simulatedSerial)

    private companion object {
        const val MOST_WAITING_LINES = 1_000
    }
}

val Context.reconApplication: ReconApplication get() = applicationContext as ReconApplication
