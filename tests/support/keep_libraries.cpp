#include <dlfcn.h>

/// Keeps libraries loaded. The leak sanitizer cannot name a module that was unloaded, and the
/// OpenGL driver is unloaded before its leaks are reported.
int dlclose(void* /*library*/) noexcept { return 0; }
