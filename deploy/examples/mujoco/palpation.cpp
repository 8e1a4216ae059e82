// A robot finger palpates a soft body. MuJoCo simulates a finger with three joints, libpalpate
// computes the tissue's force on its tip, and the joints feel that force.
//
//   palpation DATASET.h5 [DEPTH_MM]
//
// Build, with libpalpate and libmujoco-dev installed:
//   cmake -B build -DCMAKE_PREFIX_PATH=PREFIX && cmake --build build
//
// MuJoCo's own contacts are not used: its soft bodies are springs between points. Palpate's force
// comes from precomputed equilibria of the body and has an error bound in newtons. Each step gets
// the force for the position of the tip (palpate_contact_update) and applies it (mj_applyFT).
// Dataset and MuJoCo scene share one frame, in metres.
#include <mujoco/mujoco.h>
#include <palpate.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr double link = 0.1;                       // m, length of each of the two links
constexpr double reach = 0.08, height = 0.12;      // m, from the base to the touched point
constexpr double stiffness = 500, damping = 6;     // N/m and N s/m, of the controller at the tip
constexpr double duration = 4, print_every = 0.1;  // s

void need(palpate_status status) {
  if (status != PALPATE_OK) throw std::runtime_error(palpate_last_error());
}

/// A dataset, its contact and its surface; frees the handles.
struct Body {
  explicit Body(const char* file) {
    palpate_dataset* opened = nullptr;
    need(palpate_dataset_open(file, nullptr, &opened));
    dataset.reset(opened);
    palpate_contact* made = nullptr;
    need(palpate_contact_create(opened, nullptr, &made));
    contact.reset(made);
    need(palpate_dataset_space(opened, 0, &space));
    auto info = PALPATE_INIT(palpate_dataset_info);
    need(palpate_dataset_describe(opened, &info));
    vertices.resize(3 * static_cast<std::size_t>(info.vertex_count));
    triangles.resize(3 * static_cast<std::size_t>(info.triangle_count));
    need(palpate_dataset_vertices(opened, vertices.data(), vertices.size()));
    need(palpate_dataset_triangles(opened, triangles.data(), triangles.size()));
    findNormal();
  }

  std::unique_ptr<palpate_dataset, void (*)(palpate_dataset*)> dataset{nullptr,
                                                                       palpate_dataset_close};
  std::unique_ptr<palpate_contact, void (*)(palpate_contact*)> contact{nullptr,
                                                                       palpate_contact_destroy};
  palpate_space_info space = PALPATE_INIT(palpate_space_info);
  std::vector<double> vertices;
  std::vector<int32_t> triangles;
  double normal[3] = {0, 0, 0};  // outward, at the touched point

 private:
  /// Sets `normal` to the mean of the triangles around the touched vertex.
  void findNormal() {
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
      const int32_t* c = &triangles[t];
      if (c[0] != space.vertex && c[1] != space.vertex && c[2] != space.vertex) continue;
      double a[3], b[3], cross[3];
      mju_sub3(a, &vertices[3 * c[1]], &vertices[3 * c[0]]);
      mju_sub3(b, &vertices[3 * c[2]], &vertices[3 * c[0]]);
      mju_cross(cross, a, b);
      mju_addTo3(normal, cross);
    }
    mju_normalize3(normal);
  }
};

/// Formats numbers as an MJCF list.
template <class Numbers>
std::string listed(const Numbers& numbers) {
  std::string text;
  for (const auto number : numbers) {
    char word[32];
    std::snprintf(word, sizeof word, "%.9g ", static_cast<double>(number));
    text += word;
  }
  return text;
}

/// Returns the MJCF scene: the body at rest and a finger with three joints. The base of the finger
/// is `height` above the touched point.
std::string sceneOf(const Body& body) {
  // Frame of the base: z along the normal, x toward the touched point.
  double x[3], y[3];
  const double* z = body.normal;
  const double aside[3] = {std::abs(z[0]) < 0.9 ? 1.0 : 0.0, std::abs(z[0]) < 0.9 ? 0.0 : 1.0, 0};
  mju_addScl3(x, aside, z, -mju_dot3(aside, z));
  mju_normalize3(x);
  mju_cross(y, z, x);
  std::vector<double> base(3);
  for (int i = 0; i < 3; ++i) base[i] = body.space.rest_position[i] + height * z[i] - reach * x[i];
  const std::vector<double> axes = {x[0], x[1], x[2], y[0], y[1], y[2]};
  const std::string end = std::to_string(link) + " 0 0";
  const std::string geom = "<geom type='capsule' size='0.006' fromto='0 0 0 " + end + "'/>";
  std::string motors;
  for (const char* joint : {"turn", "shoulder", "elbow"})
    motors += std::string("<motor joint='") + joint + "'/>";
  return "<mujoco><compiler angle='radian'/><option timestep='0.001'/>"
         "<asset><mesh name='body' vertex='" +
         listed(body.vertices) + "' face='" + listed(body.triangles) +
         "'/></asset><default><geom contype='0' conaffinity='0'/><joint armature='1e-4'/></default>"
         "<worldbody><light pos='0 0 1'/><geom type='mesh' mesh='body' rgba='.7 .3 .3 1'/>"
         "<body pos='" +
         listed(base) + "' xyaxes='" + listed(axes) +
         "'><joint name='turn' axis='0 0 1'/><joint name='shoulder' axis='0 1 0'/>" + geom +
         "<body pos='" + end + "'><joint name='elbow' axis='0 1 0'/>" + geom +
         "<site name='tip' pos='" + end + "'/></body></body></worldbody><actuator>" + motors +
         "</actuator></mujoco>";
}

using Model = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using Data = std::unique_ptr<mjData, void (*)(mjData*)>;

Model modelOf(const std::string& scene) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(scene.size()));
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), "scene.xml")], scene.data(),
              scene.size());
  char error[500] = "";
  Model model{mj_loadXML("scene.xml", files.get(), error, sizeof error), mj_deleteModel};
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

/// Computes the joint angles with the tip `above` the surface (m) and the elbow up.
void pose(double above, double q[3]) {
  const double down = height - above, distance = std::hypot(reach, down);
  const double bend = std::acos(distance / 2 / link);
  q[0] = 0;
  q[1] = std::atan2(down, reach) - bend;
  q[2] = 2 * bend;
}

/// Estimates the force at the tip from the motor torques, as a robot without a force sensor does.
/// Solves J^T f = gravity and inertia - torque.
void feltInJoints(const mjModel* model, const mjData* data, const double jacobian[9],
                  double force[3]) {
  double rest[3];
  for (int i = 0; i < 3; ++i) rest[i] = data->qfrc_bias[i] - data->ctrl[i];
  double normal_equations[9], right[3];
  mju_mulMatMatT(normal_equations, jacobian, jacobian, 3, 3, 3);
  mju_mulMatVec(right, jacobian, rest, 3, model->nv);
  mju_cholFactor(normal_equations, 3, 0);
  mju_cholSolve(force, normal_equations, right, 3);
}

void run(const Body& body, double depth) {
  const Model model = modelOf(sceneOf(body));
  const Data data{mj_makeData(model.get()), mj_deleteData};
  const int tip = mj_name2id(model.get(), mjOBJ_SITE, "tip");
  const double start = 0.002;  // m, above the surface
  pose(start, data->qpos);

  std::printf(
      "#  time   depth      force of the tissue, N           felt in the joints, N"
      "            |error| <\n");
  for (double next = 0; data->time < duration;) {
    mj_step1(model.get(), data.get());
    const double* x = &data->site_xpos[3 * tip];

    // Apply the force of the tissue to the tip.
    auto touch = PALPATE_INIT(palpate_touch);
    need(palpate_contact_update(body.contact.get(), x, 1, &touch));
    const double no_torque[3] = {0, 0, 0};
    mju_zero(data->qfrc_applied, model->nv);
    mj_applyFT(model.get(), data.get(), touch.force, no_torque, x, model->site_bodyid[tip],
               data->qfrc_applied);

    // Control the tip with a spring and a damper; its target moves in and out along the normal.
    double jacobian[9], velocity[3], pull[3];
    mj_jacSite(model.get(), data.get(), jacobian, nullptr, tip);
    mju_mulMatVec(velocity, jacobian, data->qvel, 3, model->nv);
    const double inward = depth * 0.5 * (1 - std::cos(2 * mjPI * data->time / duration)) - start;
    for (int i = 0; i < 3; ++i) {
      const double wanted = body.space.rest_position[i] - inward * body.normal[i];
      pull[i] = stiffness * (wanted - x[i]) - damping * velocity[i];
    }
    mju_mulMatTVec(data->ctrl, jacobian, pull, 3, model->nv);
    mju_addTo(data->ctrl, data->qfrc_bias, model->nv);  // gravity

    if (data->time >= next) {
      double felt[3], from_rest[3];
      feltInJoints(model.get(), data.get(), jacobian, felt);
      mju_sub3(from_rest, body.space.rest_position, x);
      std::printf("%7.3f %7.3f  %9.4f %9.4f %9.4f   %9.4f %9.4f %9.4f   %9.2g%s\n", data->time,
                  1e3 * mju_dot3(from_rest, body.normal), touch.force[0], touch.force[1],
                  touch.force[2], felt[0], felt[1], felt[2], touch.error_bound,
                  touch.touching ? "  touching" : "");
      next += print_every;
    }
    mj_step2(model.get(), data.get());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: palpation DATASET.h5 [DEPTH_MM]\n");
    return 2;
  }
  try {
    run(Body(argv[1]), 1e-3 * (argc > 2 ? std::atof(argv[2]) : 8));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "palpation: %s\n", error.what());
    return 1;
  }
}
