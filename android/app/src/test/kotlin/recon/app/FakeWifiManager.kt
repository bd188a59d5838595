package recon.app

import android.content.Context
import android.net.wifi.IWifiManager
import android.net.wifi.WifiManager
import android.os.Looper
import org.robolectric.annotation.Implementation
import org.robolectric.annotation.Implements

/** In place of Robolectric's, which refers to classes that Android 14 does not have. */
@Implements(WifiManager::class)
class FakeWifiManager {
    @Implementation
    @Suppress("TestFunctionName", "UNUSED_PARAMETER")
    fun __constructor__(context: Context?, service: IWifiManager?, looper: Looper?) = Unit
}
