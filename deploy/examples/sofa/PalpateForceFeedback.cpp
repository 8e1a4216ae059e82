// A sketch, not compiled here; see PalpateForceFeedback.h.
#include "PalpateForceFeedback.h"

#include <sofa/core/ObjectFactory.h>
#include <sofa/simulation/AnimateEndEvent.h>

namespace palpate_sofa {

PalpateForceFeedback::PalpateForceFeedback()
    : d_dataset(initData(&d_dataset, "dataset", "Palpate dataset, OUT.h5")),
      d_device(initData(&d_device, std::string("touch"), "device",
                        "Name of the device, for its limits")),
      d_period(initData(&d_period, 1e-3, "period", "Seconds between two calls of the driver")),
      d_scale(initData(&d_scale, 1.0, "scale", "Metres per unit of the scene")),
      d_displacements(initData(&d_displacements, "displacements",
                               "Of the surface's vertices, units of the scene")) {
  f_listening.setValue(true);
}

void PalpateForceFeedback::init() {
  ForceFeedback::init();
  palpate_dataset* dataset = nullptr;
  palpate_contact* contact = nullptr;
  palpate_guard* guard = nullptr;
  palpate_guard_options limits = PALPATE_INIT(palpate_guard_options);
  const bool ready =
      palpate_dataset_open(d_dataset.getFullPath().c_str(), nullptr, &dataset) == PALPATE_OK &&
      palpate_contact_create(dataset, nullptr, &contact) == PALPATE_OK &&
      palpate_guard_defaults(d_device.getValue().c_str(), d_period.getValue(), &limits) ==
          PALPATE_OK &&
      palpate_guard_create(&limits, &guard) == PALPATE_OK;
  m_dataset.reset(dataset);
  m_contact.reset(contact);
  m_guard.reset(guard);
  if (!ready) msg_error() << palpate_last_error();
  d_componentState.setValue(ready ? sofa::core::objectmodel::ComponentState::Valid
                                  : sofa::core::objectmodel::ComponentState::Invalid);
}

void PalpateForceFeedback::computeForce(SReal x, SReal y, SReal z, SReal, SReal, SReal, SReal,
                                        SReal& fx, SReal& fy, SReal& fz) {
  fx = fy = fz = 0;
  if (!m_guard || !d_activate.getValue()) return;
  const double scale = d_scale.getValue();
  const double tool[3] = {scale * x, scale * y, scale * z};
  palpate_touch touch = PALPATE_INIT(palpate_touch);
  palpate_guarded_force force = PALPATE_INIT(palpate_guarded_force);
  // A driver that knows that its device is gone should say so: PALPATE_READING_LOST. SOFA's do not
  // tell.
  if (palpate_contact_update(m_contact.get(), tool, 1, &touch) != PALPATE_OK ||
      palpate_guard_limit(m_guard.get(), tool, &touch, PALPATE_READING_FRESH, &force) != PALPATE_OK)
    return;
  fx = force.force[0];
  fy = force.force[1];
  fz = force.force[2];
  if (const std::unique_lock lock(m_seen_mutex, std::try_to_lock); lock) m_seen = touch;
}

void PalpateForceFeedback::computeWrench(const Transform& world_H_tool, const SpatialVector&,
                                         SpatialVector& W_tool_world) {
  const auto& x = world_H_tool.getOrigin();
  SReal fx, fy, fz;
  computeForce(x[0], x[1], x[2], 0, 0, 0, 1, fx, fy, fz);
  W_tool_world.clear();
  W_tool_world.setForce({fx, fy, fz});  // a point tool gives no torque
}

void PalpateForceFeedback::handleEvent(sofa::core::objectmodel::Event* event) {
  if (!m_dataset || !sofa::simulation::AnimateEndEvent::checkEventType(event)) return;
  palpate_touch touch{};
  {
    const std::lock_guard lock(m_seen_mutex);
    touch = m_seen;
  }
  if (touch.size == 0) return;
  palpate_dataset_info info = PALPATE_INIT(palpate_dataset_info);
  palpate_dataset_describe(m_dataset.get(), &info);
  auto displacements = sofa::helper::getWriteOnlyAccessor(d_displacements);
  displacements.resize(static_cast<std::size_t>(info.vertex_count));
  if (palpate_touch_displacements(m_dataset.get(), &touch, displacements.wref().data()->ptr(),
                                  3 * displacements.size()) != PALPATE_OK) {
    msg_error() << palpate_last_error();
    return;
  }
  for (auto& u : displacements.wref()) u /= static_cast<float>(d_scale.getValue());
}

const int registered =
    sofa::core::RegisterObject("Force feedback from a precomputed Palpate dataset")
        .add<PalpateForceFeedback>();

}  // namespace palpate_sofa
