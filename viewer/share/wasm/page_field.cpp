// What a page calls: the fields, compiled to WebAssembly. Numbers are doubles in SI, memory is the
// module's, and all of it is of one thread (the page's worker).

#include <algorithm>
#include <functional>
#include <optional>

#include "common/base/parallel.hpp"
#include "viewer/organ/touched_organ.hpp"

#define PALPATE_PAGE(name) extern "C" __attribute__((export_name(#name))) auto name

namespace palpate {

/// A page has one thread for the field, and prepares in pieces.
void inParallel(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t n = 0; n < count; ++n) task(n);
}

namespace {

std::optional<TouchedOrgan> touched;
std::vector<float> shape;
std::array<double, 12> answer;
std::string about;

Eigen::Vector3d placeOf(std::int32_t triangle, double u, double v) {
  return touched->positionOf({triangle, {1 - u - v, u, v}});
}

}  // namespace
}  // namespace palpate

using namespace palpate;

PALPATE_PAGE(allocate)(std::size_t size)->void* { return std::malloc(size); }
PALPATE_PAGE(release)(void* memory)->void { std::free(memory); }

/// Bytes of encode(), which may go afterwards. An organ that is none ends the module.
PALPATE_PAGE(openOrgan)(const char* bytes, std::size_t size)->void {
  touched.emplace(decode({bytes, size}));
  shape.resize(3 * touched->organ().vertices.size());
}

PALPATE_PAGE(vertexCount)()->std::size_t { return touched->organ().vertices.size(); }
PALPATE_PAGE(vertices)()->const double* { return touched->organ().vertices.front().data(); }
PALPATE_PAGE(triangleCount)()->std::size_t { return touched->organ().triangles.size(); }
PALPATE_PAGE(triangles)()->const std::int32_t* {
  return touched->organ().triangles.front().data();
}
PALPATE_PAGE(touchOfTriangle)()->const std::int32_t* {
  return touched->organ().touch_of_triangle.data();
}
PALPATE_PAGE(touchCount)()->std::size_t { return touched->organ().touches.size(); }
/// Nine numbers: radius of the finger, of the workspace, the rest position.
PALPATE_PAGE(touchNumbers)(std::size_t touch)->const double* {
  const CarriedTouch& carried = touched->organ().touches.at(touch);
  answer = {carried.finger_radius,
            touched->organ().spaces[static_cast<std::size_t>(carried.spaces.front())]
                .lattice.radius(),
            carried.rest.x(), carried.rest.y(), carried.rest.z()};
  return answer.data();
}

/// One piece of what a touch at a point of the surface needs; 0 when nothing is lacking.
PALPATE_PAGE(prepare)(std::size_t touch, std::int32_t triangle, double u, double v)->int {
  return touched->prepare(touch, placeOf(triangle, u, v)) ? 1 : 0;
}
PALPATE_PAGE(prepareAhead)(std::size_t touch, std::int32_t triangle, double u, double v)->int {
  return touched->prepareAhead(touch, placeOf(triangle, u, v)) ? 1 : 0;
}

/// Twelve numbers: force, error bound, energy, coverage, inside; then the place s, and two of the
/// drive.
PALPATE_PAGE(evaluate)
(std::size_t touch, std::int32_t triangle, double u, double v, double px, double py, double pz)
    ->const double* {
  const Eigen::Vector3d s = placeOf(triangle, u, v);
  const AreaSample sample = touched->evaluate(touch, s, {px, py, pz});
  answer = {sample.force.x(), sample.force.y(), sample.force.z(),
            sample.error_bound, sample.energy,  sample.coverage,
            sample.inside ? 1.0 : 0.0,          s.x(), s.y(), s.z()};
  return answer.data();
}

/// Displacements of all vertices there.
PALPATE_PAGE(shapeAt)
(std::size_t touch, std::int32_t triangle, double u, double v, double px, double py, double pz)
    ->const float* {
  touched->shapeAt(touch, {triangle, {1 - u - v, u, v}}, {px, py, pz}, shape);
  return shape.data();
}
