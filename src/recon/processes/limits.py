"""Limits that a process gives itself before it reads what others have made."""

import os

NICENESS = 10
"""The station is more urgent."""


def limit_itself(memory_bytes: int, cpu_s: int | None = None, *, writes_files: bool = True) -> None:
    """Limit this process's address space, processor time and files, and lower its priority.

    Call it before numpy, GDAL or PROJ are imported. On Windows nothing but their settings is
    limited: the time limit of whoever started the process remains.
    """
    # One thread each: their stacks would count as memory.
    os.environ.update(OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1", GDAL_NUM_THREADS="1")
    # Nothing is fetched, whatever a file names.
    os.environ.update(CPL_VSIL_CURL_ALLOWED_EXTENSIONS="{none}", PROJ_NETWORK="OFF")
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if cpu_s is not None:
        resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))
    if not writes_files:
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
