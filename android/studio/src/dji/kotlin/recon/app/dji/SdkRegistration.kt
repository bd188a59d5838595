package recon.app.dji

import android.content.Context
import dji.v5.common.error.IDJIError
import dji.v5.common.register.DJISDKInitEvent
import dji.v5.manager.SDKManager
import dji.v5.manager.interfaces.SDKManagerCallback

/** DJI's calls to initialise the SDK and register the app, and no decision. */
object SdkRegistration {
    fun begin(context: Context, listener: RegistrationListener) {
        SDKManager.getInstance().init(context, Callback(listener))
    }

    private class Callback(private val listener: RegistrationListener) : SDKManagerCallback {
        override fun onInitProcess(event: DJISDKInitEvent?, total: Int) {
            if (event == DJISDKInitEvent.INITIALIZE_COMPLETE) SDKManager.getInstance().registerApp()
        }

        override fun onRegisterSuccess() = listener.registered()

        override fun onRegisterFailure(error: IDJIError?) =
            listener.failed("${error?.description() ?: "no description"} (${error?.errorCode() ?: "no code"})")

        override fun onProductConnect(product: Int) = Unit

        override fun onProductDisconnect(product: Int) = Unit

        override fun onProductChanged(product: Int) = Unit

        override fun onDatabaseDownloadProgress(current: Long, total: Long) = Unit
    }
}
