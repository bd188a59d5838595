package recon.msdk5

import org.objectweb.asm.ClassReader
import org.objectweb.asm.ClassVisitor
import org.objectweb.asm.ClassWriter
import org.objectweb.asm.MethodVisitor
import org.objectweb.asm.Opcodes

/** What every method of the rewritten stubs raises. */
const val STUB = "a stub of DJI's SDK"

/**
 * Loads the adapter anew, with DJI's classes rewritten so that every body raises an exception: those of
 * the provided jar do not pass the JVM's verifier. Static initialisers do nothing.
 */
class StubLoader : ClassLoader(StubLoader::class.java.classLoader) {

    override fun loadClass(name: String, resolve: Boolean): Class<*> {
        if (!name.startsWith("dji.") && !name.startsWith("recon.msdk5.Msdk5")) return super.loadClass(name, resolve)
        return findLoadedClass(name) ?: defined(name)
    }

    private fun defined(name: String): Class<*> {
        val bytes = bytesOf(name.replace('.', '/')) ?: throw ClassNotFoundException(name)
        val used = if (name.startsWith("dji.")) rewritten(bytes) else bytes
        return defineClass(name, used, 0, used.size)
    }

    private fun rewritten(bytes: ByteArray): ByteArray {
        val writer = ClassWriter(ClassWriter.COMPUTE_MAXS)
        val visitor = object : ClassVisitor(Opcodes.ASM9, writer) {
            override fun visitMethod(
                access: Int, name: String, descriptor: String, s: String?, e: Array<String>?,
            ): MethodVisitor? {
                val target = super.visitMethod(access, name, descriptor, s, e)
                val hasBody = access and (Opcodes.ACC_ABSTRACT or Opcodes.ACC_NATIVE) == 0
                if (hasBody) target.writeBody(isInitialiser = name == "<clinit>")
                return null
            }
        }
        ClassReader(bytes).accept(visitor, ClassReader.SKIP_CODE)
        return writer.toByteArray()
    }

    private fun MethodVisitor.writeBody(isInitialiser: Boolean) {
        visitCode()
        if (isInitialiser) visitInsn(Opcodes.RETURN) else writeThrow()
        visitMaxs(0, 0)
        visitEnd()
    }

    private fun MethodVisitor.writeThrow() {
        val exception = "java/lang/UnsupportedOperationException"
        visitTypeInsn(Opcodes.NEW, exception)
        visitInsn(Opcodes.DUP)
        visitLdcInsn(STUB)
        visitMethodInsn(Opcodes.INVOKESPECIAL, exception, "<init>", "(Ljava/lang/String;)V", false)
        visitInsn(Opcodes.ATHROW)
    }
}
