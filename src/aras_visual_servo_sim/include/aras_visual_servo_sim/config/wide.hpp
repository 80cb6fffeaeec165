#pragma once

// ARAS_WIDE before a function: the same additions, products and comparisons in wider registers where the processor has
// them, and the same bytes. Loops over arrays become vector instructions of both widths.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define ARAS_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define ARAS_WIDE
#endif
