package recon.app

/** Marks a function that calls what the oldest supported Android lacks, behind a check of its version. */
@Retention(AnnotationRetention.BINARY)
@Target(AnnotationTarget.FUNCTION)
annotation class NewerAndroid
