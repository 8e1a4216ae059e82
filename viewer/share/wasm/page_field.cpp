// The functions of the WebAssembly module that a page calls. Numbers are doubles in SI units.
// Returned memory belongs to the module. Everything runs on one thread, the page's worker
// (page/field_worker.js).

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <optional>
#include <typeinfo>

#include "common/base/index.hpp"
#include "common/base/parallel.hpp"
#include "viewer/organ/touched_organ.hpp"

#ifdef __wasm__
// Exceptions are not caught here. A throw writes the message to standard error, where the page
// reads it, and ends the module. Every exception here is a std::exception. The linker replaces
// __cxa_throw by the second of these functions (--wrap), because newer libraries of Emscripten
// define __cxa_throw themselves.
extern "C" void* __cxa_allocate_exception(std::size_t size) noexcept { return std::malloc(size); }
extern "C" [[noreturn]] void __wrap___cxa_throw(void* thrown, std::type_info*, void (*)(void*)) {
  std::fputs(static_cast<const std::exception*>(thrown)->what(), stderr);
  std::abort();
}

#define PALPATE_PAGE(name) extern "C" __attribute__((export_name(#name))) auto page_##name
#else  // read by clang-tidy alone
#define PALPATE_PAGE(name) extern "C" auto page_##name
#endif

namespace palpate {

#ifdef __wasm__
/// Runs the tasks one after another, because a page has only one thread for the field.
void inParallel(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t n = 0; n < count; ++n) task(n);
}
unsigned coreCount() { return 1; }
#endif

namespace {

/// The page's organ, set by openOrgan. The functions below return pointers into it, which are valid
/// until the next call.
struct OpenOrgan {
  explicit OpenOrgan(CarriedOrgan organ)
      : touched(std::move(organ)), shape(3 * touched.organ().vertices.size()) {}
  TouchedOrgan touched;
  std::vector<float> shape;
  Eigen::Matrix<double, 10, 1> numbers;

  SurfacePoint pointAt(std::int32_t triangle, double u, double v) const {
    return {triangle, {1 - u - v, u, v}};
  }
  Eigen::Vector3d placeAt(std::int32_t triangle, double u, double v) const {
    return touched.positionOf(pointAt(triangle, u, v));
  }
};
std::optional<OpenOrgan> in_page;

}  // namespace

PALPATE_PAGE(allocate)(std::size_t size)->void* { return std::malloc(size); }
PALPATE_PAGE(release)(void* memory)->void { std::free(memory); }

/// Opens an organ from the bytes that encode() returned; they may be released afterwards. Errors as
/// in decode().
PALPATE_PAGE(openOrgan)(const char* bytes, std::size_t size)->void {
  in_page.emplace(decode({bytes, size}));
}

PALPATE_PAGE(vertexCount)()->std::size_t { return in_page->touched.organ().vertices.size(); }
PALPATE_PAGE(vertices)()->const double* { return in_page->touched.organ().vertices[0].data(); }
PALPATE_PAGE(triangleCount)()->std::size_t { return in_page->touched.organ().triangles.size(); }
PALPATE_PAGE(triangles)()->const std::int32_t* {
  return in_page->touched.organ().triangles[0].data();
}
PALPATE_PAGE(touchOfTriangle)()->const std::int32_t* {
  return in_page->touched.organ().touch_of_triangle.data();
}
PALPATE_PAGE(touchCount)()->std::size_t { return in_page->touched.organ().touches.size(); }

/// Returns five numbers, m: radius of the finger (0: none), radius of the workspace, and rest
/// position (3).
PALPATE_PAGE(touchNumbers)(std::size_t touch)->const double* {
  const CarriedOrgan& organ = in_page->touched.organ();
  const CarriedTouch& carried = organ.touches[touch];
  in_page->numbers.head<5>() << carried.finger_radius,
      organ.spaces[at(carried.spaces[0])].lattice.radius(), carried.rest;
  return in_page->numbers.data();
}

/// Does one step of the preparation for a touch at a place (prepare), or of the other sites of the
/// touch, the nearest first (prepareAhead). Returns 0 if nothing is left to do. A place is a
/// triangle and the barycentric weights u, v of the triangle's second and third corner.
PALPATE_PAGE(prepare)(std::size_t touch, std::int32_t triangle, double u, double v)->int {
  return in_page->touched.prepare(touch, in_page->placeAt(triangle, u, v)) ? 1 : 0;
}
PALPATE_PAGE(prepareAhead)(std::size_t touch, std::int32_t triangle, double u, double v)->int {
  return in_page->touched.prepareAhead(touch, in_page->placeAt(triangle, u, v)) ? 1 : 0;
}

/// Returns ten numbers: force (3), error bound, energy, coverage, 1 inside of the computed region
/// (else 0), and the rest position of the touched point (3).
PALPATE_PAGE(evaluate)
(std::size_t touch, std::int32_t triangle, double u, double v, double px, double py, double pz)
    ->const double* {
  const Eigen::Vector3d s = in_page->placeAt(triangle, u, v), p(px, py, pz);
  const AreaSample sample = in_page->touched.evaluate(touch, s, p);
  in_page->numbers << sample.force, sample.error_bound, sample.energy, sample.coverage,
      sample.inside ? 1.0 : 0.0, s;
  return in_page->numbers.data();
}

/// Returns the displacements of all vertices for this touch, [vertex][axis].
PALPATE_PAGE(shapeAt)
(std::size_t touch, std::int32_t triangle, double u, double v, double px, double py, double pz)
    ->const float* {
  in_page->touched.shapeAt(touch, in_page->pointAt(triangle, u, v), {px, py, pz}, in_page->shape);
  return in_page->shape.data();
}

}  // namespace palpate
