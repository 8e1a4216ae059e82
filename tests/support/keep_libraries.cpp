#include <dlfcn.h>

/// Keeps the library: the leak sanitizer cannot name a module that is gone, and the driver of
/// OpenGL is unloaded before what it has lost is reported.
int dlclose(void* /*library*/) noexcept { return 0; }
