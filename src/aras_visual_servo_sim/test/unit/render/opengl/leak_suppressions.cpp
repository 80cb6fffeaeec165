/** Read by LeakSanitizer: Mesa keeps a few kilobytes for each process that ever made a context. Nothing of ours. */
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa\nleak:libLLVM\n"; }
