#pragma once

/// One function compiled for several vector widths, of which the machine's is chosen when the program starts. The
/// bodies are the same, and so are the bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define MOCURATE_VECTOR_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define MOCURATE_VECTOR_CLONES
#endif
