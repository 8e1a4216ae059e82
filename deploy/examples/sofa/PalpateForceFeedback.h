// A sketch, not compiled here: a SOFA component that takes its force from libpalpate instead of a
// constraint solver. Interface of ForceFeedback as of SOFA v22-v24
// (sofa/component/haptics/ForceFeedback.h).
//
//   <PalpateForceFeedback dataset="liver.h5" device="touch" scale="1" position="0 0 0"/>
//
// beside the driver of the device (GeomagicDriver, ...), which calls computeForce from its haptic
// thread. The mesh of the scene must have the frame of the dataset, in metres; `scale` is metres
// per unit of the scene (0.001 for millimetres).
#pragma once

#include <palpate.h>
#include <sofa/component/haptics/ForceFeedback.h>
#include <sofa/core/objectmodel/DataFileName.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace palpate_sofa {

class PalpateForceFeedback : public sofa::component::haptics::ForceFeedback {
 public:
  SOFA_CLASS(PalpateForceFeedback, sofa::component::haptics::ForceFeedback);
  using Transform = sofa::defaulttype::SolidTypes<SReal>::Transform;
  using SpatialVector = sofa::defaulttype::SolidTypes<SReal>::SpatialVector;

  /// Loads the dataset and prepares contact and guard: everything that may take time or fail.
  void init() override;

  /// Haptic thread. Position of the tool in units of the scene, orientation as a quaternion (a
  /// point tool ignores it); the force in newtons. Neither allocates nor waits.
  void computeForce(SReal x, SReal y, SReal z, SReal u, SReal v, SReal w, SReal q, SReal& fx,
                    SReal& fy, SReal& fz) override;
  void computeWrench(const Transform& world_H_tool, const SpatialVector& V_tool_world,
                     SpatialVector& W_tool_world) override;

  /// Simulation thread: writes the deformed surface into `displacements` for an OglModel that shows
  /// it.
  void handleEvent(sofa::core::objectmodel::Event* event) override;

 protected:
  PalpateForceFeedback();
  ~PalpateForceFeedback() override = default;

 private:
  template <auto destroy>
  struct Destroy {
    template <class Handle>
    void operator()(Handle* handle) const {
      destroy(handle);
    }
  };

  sofa::core::objectmodel::DataFileName d_dataset;
  sofa::Data<std::string> d_device;
  sofa::Data<double> d_period, d_scale;
  sofa::Data<sofa::type::vector<sofa::type::Vec3f>> d_displacements;

  std::unique_ptr<palpate_dataset, Destroy<palpate_dataset_close>> m_dataset;
  std::unique_ptr<palpate_contact, Destroy<palpate_contact_destroy>> m_contact;
  std::unique_ptr<palpate_guard, Destroy<palpate_guard_destroy>> m_guard;

  /// The last touch, for the picture. The haptic thread only tries the lock: a picture may miss a
  /// tick, a tick never waits.
  std::mutex m_seen_mutex;
  palpate_touch m_seen{};
};

}  // namespace palpate_sofa
