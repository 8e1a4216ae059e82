// A robot finger palpates a soft body. MuJoCo simulates a finger with three joints, libpalpate
// computes the tissue's force on its tip, and the joints feel that force.
//
//   palpation DATASET.h5 [DEPTH_MM]
//
// Build, with libpalpate and libmujoco-dev installed:
//   cmake -B build -DCMAKE_PREFIX_PATH=PREFIX && cmake --build build
//
// MuJoCo's own contacts are not used: its soft bodies are springs between points. Palpate's force
// comes from precomputed equilibria of the body and has an error bound in newtons. `palpate` below
// is all that a simulation of your own needs.
#include <mujoco/mujoco.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <palpate_sensor.hpp>

namespace {

constexpr double stiffness = 500, damping = 6;     // N/m and N s/m, of the controller at the tip
constexpr double duration = 4, print_every = 0.1;  // s
constexpr double start = 0.002;                    // m, above the surface

/// The touched point is the origin, and its normal is z. The finger's links are 0.1 m long.
constexpr char scene[] = R"(<mujoco><option timestep='0.001'><flag energy='enable'/></option>
  <default><geom contype='0' conaffinity='0' size='0.006'/><joint armature='1e-4'/></default>
  <worldbody>
    <body pos='-0.08 0 0.12'><joint name='turn' axis='0 0 1'/><joint name='shoulder' axis='0 1 0'/>
      <geom type='capsule' fromto='0 0 0 0.1 0 0'/>
      <body pos='0.1 0 0'><joint name='elbow' axis='0 1 0'/>
        <geom type='capsule' fromto='0 0 0 0.1 0 0'/><site name='tip' pos='0.1 0 0'/>
  </body></body></worldbody>
  <actuator><motor joint='turn'/><motor joint='shoulder'/><motor joint='elbow'/></actuator>
</mujoco>)";

/// The finger and its controller.
struct Robot {
  Robot() {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "scene.xml", sizeof scene - 1);
    std::memcpy(files->filedata[mj_findFileVFS(files.get(), "scene.xml")], scene, sizeof scene - 1);
    char error[500] = "";
    model.reset(mj_loadXML("scene.xml", files.get(), error, sizeof error));
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
    data.reset(mj_makeData(model.get()));
    const double distance = std::hypot(0.08, 0.12 - start), bend = std::acos(distance / 0.2);
    data->qpos[1] = std::atan2(0.12 - start, 0.08) - bend;
    data->qpos[2] = 2 * bend;
    tip = mj_name2id(model.get(), mjOBJ_SITE, "tip");
  }

  /// Controls the tip with a spring and a damper. Its target moves in and out along z.
  void control(double depth) {
    mj_jacSite(model.get(), data.get(), jacobian, nullptr, tip);
    double velocity[3], pull[3];
    mju_mulMatVec(velocity, jacobian, data->qvel, 3, model->nv);
    const double inward = depth * 0.5 * (1 - std::cos(2 * mjPI * data->time / duration)) - start;
    for (int i = 0; i < 3; ++i)
      pull[i] = stiffness * ((i == 2 ? -inward : 0) - data->site_xpos[3 * tip + i]) -
                damping * velocity[i];
    mju_mulMatTVec(data->ctrl, jacobian, pull, 3, model->nv);
    mju_addTo(data->ctrl, data->qfrc_bias, model->nv);  // gravity
  }

  /// Estimates the force at the tip from the motor torques, as a robot without a force sensor does.
  /// Solves J^T f = gravity and inertia - torque.
  void felt(double force[3]) const {
    double rest[3], normal_equations[9], right[3];
    mju_sub3(rest, data->qfrc_bias, data->ctrl);
    mju_mulMatMatT(normal_equations, jacobian, jacobian, 3, 3, 3);
    mju_mulMatVec(right, jacobian, rest, 3, model->nv);
    mju_cholFactor(normal_equations, 3, 0);
    mju_cholSolve(force, normal_equations, right, 3);
  }

  /// Prints the force, and accounts for energy: the motors' work becomes energy of the finger and
  /// work on the tissue.
  void report(const palpate::Wrench& wrench) {
    for (int i = 0; i < 3; ++i)
      motors += 0.5 * (data->ctrl[i] + torque[i]) * (data->qpos[i] - angle[i]);
    mju_copy3(torque, data->ctrl);
    mju_copy3(angle, data->qpos);
    const double finger = data->energy[0] + data->energy[1];
    if (data->time == 0) motors = finger;
    worst = std::max(worst, std::abs(motors - finger - wrench.work));
    most = std::max(most, wrench.energy);
    if (data->time < next_print) return;
    next_print += print_every;
    double f[3];
    felt(f);
    std::printf("%7.3f %7.3f  %9.4f %9.4f %9.4f   %9.4f %9.4f %9.4f   %9.2g%s\n", data->time,
                -1e3 * wrench.point[2], wrench.force[0], wrench.force[1], wrench.force[2], f[0],
                f[1], f[2], wrench.error_bound, wrench.touching ? "  touching" : "");
  }

  std::unique_ptr<mjModel, void (*)(mjModel*)> model{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, void (*)(mjData*)> data{nullptr, mj_deleteData};
  int tip = 0;
  double next_print = 0;  // s
  double jacobian[9], torque[3] = {}, angle[3] = {};
  double motors = 0, worst = 0, most = 0;  // J
};

void palpateWith(Robot& robot, const char* file, double depth) {
  palpate::Sensor sensor(file);
  sensor.placeFacingUp(0, {0, 0, 0});
  mjModel* model = robot.model.get();
  mjData* data = robot.data.get();
  const double *x = &data->site_xpos[3 * robot.tip], no_torque[3] = {0, 0, 0};
  while (data->time < duration) {
    mj_step1(model, data);
    const palpate::Wrench wrench = sensor.step(model->opt.timestep, {x[0], x[1], x[2]});
    mju_zero(data->qfrc_applied, model->nv);
    mj_applyFT(model, data, wrench.force.data(), no_torque, x, model->site_bodyid[robot.tip],
               data->qfrc_applied);
    robot.control(depth);
    robot.report(wrench);
    mj_step2(model, data);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: palpation DATASET.h5 [DEPTH_MM]\n");
    return 2;
  }
  try {
    Robot robot;
    std::printf(
        "#  time   depth      force of the tissue, N           felt in the joints, N"
        "            |error| <\n");
    palpateWith(robot, argv[1], 1e-3 * (argc > 2 ? std::atof(argv[2]) : 8));
    std::printf("# energy: %.4g mJ stored in the tissue, at most %.2g mJ not accounted for\n",
                1e3 * robot.most, 1e3 * robot.worst);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "palpation: %s\n", error.what());
    return 1;
  }
}
