package recon.app

import android.content.ContentProvider
import android.content.ContentValues
import android.content.Intent
import android.database.Cursor
import android.database.MatrixCursor
import android.net.Uri
import android.os.ParcelFileDescriptor
import android.provider.OpenableColumns
import java.io.File
import java.io.FileNotFoundException

/** Gives the newest log to the app that the person shares it with, to read only. */
class LogProvider : ContentProvider() {
    override fun onCreate(): Boolean = true

    override fun getType(uri: Uri): String = TYPE

    override fun openFile(uri: Uri, mode: String): ParcelFileDescriptor =
        ParcelFileDescriptor.open(fileOf(uri), ParcelFileDescriptor.MODE_READ_ONLY)

    override fun query(uri: Uri, columns: Array<String>?, w: String?, a: Array<String>?, s: String?): Cursor {
        val file = fileOf(uri)
        val cursor = MatrixCursor(arrayOf(OpenableColumns.DISPLAY_NAME, OpenableColumns.SIZE))
        cursor.addRow(listOf(file.name, file.length()))
        return cursor
    }

    override fun insert(uri: Uri, values: ContentValues?): Uri? = null

    override fun update(uri: Uri, values: ContentValues?, w: String?, a: Array<String>?): Int = 0

    override fun delete(uri: Uri, w: String?, a: Array<String>?): Int = 0

    /** Only the newest log has an address: a path from outside never reaches the storage. */
    private fun fileOf(uri: Uri): File = context?.reconApplication?.log?.newest()?.takeIf { uriOf(it) == uri }
        ?: throw FileNotFoundException("No such log: $uri")

    companion object {
        private const val TYPE = "text/plain"
        private const val AUTHORITY = "recon.app.log"

        private fun uriOf(file: File): Uri =
            Uri.Builder().scheme("content").authority(AUTHORITY).appendPath(file.name).build()

        /** The choice of an app to share a log with. */
        fun sharing(log: File, subject: String): Intent {
            val send = Intent(Intent.ACTION_SEND)
                .setType(TYPE)
                .putExtra(Intent.EXTRA_SUBJECT, subject)
                .putExtra(Intent.EXTRA_STREAM, uriOf(log))
                .addFlags(Intent.FLAG_GRANT_READ_URI_PERMISSION)
            return Intent.createChooser(send, subject)
        }
    }
}
