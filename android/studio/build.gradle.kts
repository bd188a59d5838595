// Not built by us: Gradle and DJI's runtime cannot be had where Recon is tested. See ../README.md.
import java.util.Properties

plugins {
    id("com.android.application") version "8.13.0"
    id("org.jetbrains.kotlin.android") version "2.4.21"
}

// The key of a DJI developer account for the package recon.app; local.properties is never committed.
val local = Properties().apply { file("local.properties").takeIf { it.exists() }?.reader()?.use(::load) }
val djiApiKey: String = local.getProperty("dji.apiKey")
    ?: error("dji.apiKey is missing in android/studio/local.properties: create a key for recon.app at developer.dji.com")

android {
    namespace = "recon.app"
    compileSdk = 34

    defaultConfig {
        applicationId = "recon.app"
        minSdk = 26
        targetSdk = 34
        versionCode = 1
        versionName = "0.1.0"
        manifestPlaceholders["djiApiKey"] = djiApiKey
        // DJI's libraries exist for this processor only.
        ndk { abiFilters += "arm64-v8a" }
    }

    // The flavour adds to the manifest of the app what DJI's SDK needs.
    flavorDimensions += "aircraft"
    productFlavors { create("dji") { dimension = "aircraft" } }

    sourceSets["main"].apply {
        manifest.srcFile("../app/src/main/AndroidManifest.xml")
        res.srcDirs("../app/src/main/res")
        kotlin.srcDirs("../core/src/main/kotlin", "../msdk5/src/main/kotlin", "../app/src/main/kotlin")
    }

    compileOptions {
        sourceCompatibility = JavaVersion.VERSION_17
        targetCompatibility = JavaVersion.VERSION_17
    }
    packaging.jniLibs {
        // DJI's libraries check themselves: they must be neither stripped nor compressed anew.
        keepDebugSymbols += "**/*.so"
        useLegacyPackaging = true
        pickFirsts += "**/libc++_shared.so"
    }
}

kotlin { jvmToolchain(17) }

dependencies {
    implementation("com.google.zxing:core:3.5.4")
    implementation("com.dji:dji-sdk-v5-aircraft:5.18.0")
    compileOnly("com.dji:dji-sdk-v5-aircraft-provided:5.18.0")
    runtimeOnly("com.dji:dji-sdk-v5-networkImp:5.18.0")
}
