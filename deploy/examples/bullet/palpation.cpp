// A robot finger palpates a soft body. Bullet simulates a gantry of three slides with a finger,
// libpalpate computes the tissue's force on its tip, and the slides feel that force.
//
//   palpation DATASET.h5 [DEPTH_MM]
//
// Build, with libpalpate and libbullet-dev installed:
//   cmake -B build -DCMAKE_PREFIX_PATH=PREFIX && cmake --build build
//
// Bullet's own contacts and soft bodies are not used. `palpateWith` below is all that a simulation
// of your own needs.
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <cstdlib>
#include <palpate_sensor.hpp>

namespace {

constexpr double time_step = 0.001, duration = 4;  // s
constexpr int print_every = 100;                   // steps
constexpr double stiffness = 500, damping = 20;    // N/m and N s/m, of the controller
constexpr double start = 0.002;                    // m, above the surface
constexpr double masses[3] = {0.2, 0.15, 0.1};     // kg, of the slides along x, y and z
constexpr double below = 0.05;                     // m, from the last slide down to the tip

/// The gantry and its controller. The touched point is the origin, and its normal is z.
struct Robot {
  Robot() {
    gantry.setBasePos({0, 0, btScalar(below + start)});
    for (int i = 0; i < 3; ++i) {
      btVector3 axis(0, 0, 0);
      axis[i] = 1;
      const btScalar inertia = 1e-4;  // kg m^2; the slides do not turn
      gantry.setupPrismatic(i, btScalar(masses[i]), {inertia, inertia, inertia}, i - 1,
                            btQuaternion::getIdentity(), axis, {0, 0, 0}, {0, 0, 0}, true);
    }
    gantry.finalizeMultiDof();
    gantry.setLinearDamping(0);
    gantry.setAngularDamping(0);
    world.setGravity({0, 0, btScalar(-9.81)});
    world.addMultiBody(&gantry);
  }

  btVector3 slide() {
    btAlignedObjectArray<btQuaternion> turns;
    btAlignedObjectArray<btVector3> places;
    gantry.forwardKinematics(turns, places);
    return places[3];  // the base is the first
  }
  palpate::Vector tip() {
    const btVector3 at = slide();
    return {at.x(), at.y(), at.z() - below};
  }

  /// Pulls the tip with a spring and a damper. Its target moves in and out along z.
  void control(double depth) {
    const palpate::Vector at = tip();
    const double inward = depth * 0.5 * (1 - std::cos(2 * SIMD_PI * time / duration)) - start;
    for (int i = 0; i < 3; ++i) {
      motor[i] = stiffness * ((i == 2 ? -inward : 0) - at[i]) - damping * gantry.getJointVel(i);
      if (i == 2) motor[i] += 9.81 * masses[2];
      gantry.addJointTorque(i, btScalar(motor[i]));
    }
  }

  /// Accounts for energy: the motors' work becomes energy of the robot and work on the tissue.
  /// Prints the force of the tissue, and the force that a robot without a sensor feels in its
  /// motors.
  void report(const palpate::Wrench& wrench) {
    double robot = 0;
    for (int i = 0; i < 3; ++i) {
      const double q = gantry.getJointPos(i), speed = gantry.getJointVel(i);
      motors += 0.5 * (motor[i] + motor_before[i]) * (q - before[i]);
      motor_before[i] = motor[i];
      before[i] = q;
      double moved = 0;  // mass that this slide moves
      for (int j = i; j < 3; ++j) moved += masses[j];
      robot += 0.5 * moved * speed * speed;
    }
    robot += 9.81 * masses[2] * before[2];
    worst = std::max(worst, std::abs(motors - robot - wrench.work));
    most = std::max(most, wrench.energy);
    if (std::lround(time / time_step) % print_every != 0) return;
    std::printf("%7.3f %7.3f  %9.4f %9.4f %9.4f   %9.4f %9.4f %9.4f   %9.2g%s\n", time,
                -1e3 * wrench.point[2], wrench.force[0], wrench.force[1], wrench.force[2],
                -motor[0], -motor[1], 9.81 * masses[2] - motor[2], wrench.error_bound,
                wrench.touching ? "  touching" : "");
  }

  void step() {
    world.stepSimulation(btScalar(time_step), 0);
    time += time_step;
  }

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase pairs;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld world{&dispatcher, &pairs, &solver, &configuration};
  btMultiBody gantry{3, 1, {1, 1, 1}, true, false};
  double time = 0, motor[3] = {}, motor_before[3] = {}, before[3] = {};
  double motors = 0, worst = 0, most = 0;  // J
};

btVector3 vectorOf(const palpate::Vector& v) {
  return {btScalar(v[0]), btScalar(v[1]), btScalar(v[2])};
}

void palpateWith(Robot& robot, const char* file, double depth) {
  palpate::Sensor sensor(file);
  sensor.placeFacingUp(0, {0, 0, 0});
  for (int step = 0; step * time_step < duration; ++step) {
    const palpate::Wrench wrench = sensor.step(time_step, robot.tip());
    const btVector3 slide = robot.slide();
    robot.gantry.addLinkForce(2, vectorOf(wrench.force));
    robot.gantry.addLinkTorque(2, vectorOf(wrench.torque({slide.x(), slide.y(), slide.z()})));
    robot.control(depth);
    robot.report(wrench);
    robot.step();
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
