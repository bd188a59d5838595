package recon.app.dji

import android.app.Application
import android.content.Context
import recon.app.AircraftSource
import recon.app.ReconApplication
import recon.msdk5.Msdk5
import recon.msdk5.Msdk5Aircraft
import recon.msdk5.WpmzCheck
import java.io.File

/** The app with DJI's runtime. Compiled and linked against DJI's signatures; never run. */
class DjiApplication : ReconApplication() {

    override fun attachBaseContext(base: Context) {
        super.attachBaseContext(base)
        // Unpacks DJI's classes, before any of them is used. It is in DJI's runtime only, and so called by name.
        Class.forName("com.cySdkyc.clx.Helper").getMethod("install", Application::class.java).invoke(null, this)
    }

    override fun aircraftSource(): AircraftSource = DjiSource(
        register = { SdkRegistration.begin(this, it) },
        connect = { Msdk5Aircraft(sdk(), System::nanoTime, System::currentTimeMillis) },
    )

    private fun sdk() = Msdk5(missionFolder(), WpmzCheck(this)::of, System::nanoTime)

    private fun missionFolder() = File(filesDir, "missions").apply { mkdirs() }
}
