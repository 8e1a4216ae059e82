/* Parts of the programs of deploy/bundle that adapt them to the system where they run: functions
 * that glibc 2.31 lacks, and the graphics, which are loaded at the start, so that only a window
 * needs them. */
#include <dlfcn.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

/* glibc 2.32. Zero: other threads may exist. */
char __libc_single_threaded;

/* glibc 2.36 */
unsigned arc4random(void) {
  unsigned number;
  while (getrandom(&number, sizeof number, 0) != sizeof number) continue;
  return number;
}

/* glibc 2.38; Debian's ZeroMQ calls that of libbsd. */
size_t strlcpy(char* to, const char* from, size_t size) {
  if (size > 0) snprintf(to, size, "%s", from);
  return strlen(from);
}

/* Variables of the C library. Debian's static libraries access them directly, which a shared
 * library cannot, so the linker replaces them by these copies (--wrap). */
extern FILE *__real_stdout, *__real_stderr;
FILE *__wrap_stdout, *__wrap_stderr;
const struct in6_addr __wrap_in6addr_any;
__attribute__((constructor(101))) static void copyStreams(void) {
  __wrap_stdout = __real_stdout;
  __wrap_stderr = __real_stderr;
}

/* Replaces functions that Palpate never calls: multicast and Kerberos of ZeroMQ, orderings of
 * MUMPS. */
void palpate_absent(void) {
  fputs("palpate: called a part of a library that deploy/bundle leaves out; report this\n", stderr);
  abort();
}
/* ZeroMQ begins and ends multicast in any case. */
int pgm_init(void) { return 1; }
int pgm_shutdown(void) { return 1; }

/* A file with a line GRAPHICS(name) for each function of GLFW and OpenGL. Each becomes a jump to
 * the function that findGraphics found. */
#ifdef PALPATE_GRAPHICS
#define GRAPHICS(name)                                                                       \
  static void* host_##name;                                                                  \
  __asm__(".text\n.globl " #name "\n.type " #name ", @function\n" #name ": jmp *host_" #name \
          "(%rip)\n");
#include PALPATE_GRAPHICS
#undef GRAPHICS

static const char* trouble;
static void* absent(void) { return NULL; }
static int absentError(const char** text) {
  *text = trouble;
  return 1;
}

static void* library(const char* name) {
  void* const found = dlopen(name, RTLD_NOW);
  if (found == NULL && trouble == NULL) trouble = strdup(dlerror());
  return found;
}

/* If a library is missing, glfwInit fails, and glfwGetError names the library. */
__attribute__((constructor)) static void findGraphics(void) {
  void* gl = dlopen("libOpenGL.so.0", RTLD_NOW);
  if (gl == NULL) gl = library("libGL.so.1");
  void* const glfw = library("libglfw.so.3"); /* of deploy/bundle; needs libX11 */
#define GRAPHICS(name)                                                          \
  if (trouble == NULL) host_##name = dlsym(#name[2] == 'f' ? glfw : gl, #name); \
  if (host_##name == NULL) host_##name = (void*)absent;
#include PALPATE_GRAPHICS
  if (trouble != NULL) host_glfwGetError = (void*)absentError;
}
#endif
