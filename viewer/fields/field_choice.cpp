#include "viewer/fields/field_choice.hpp"

#include "common/base/error.hpp"
#include "viewer/fields/potential_field.hpp"
#include "viewer/fields/rbf_field.hpp"
#include "viewer/fields/tricubic_field.hpp"
#include "viewer/fields/trilinear_field.hpp"

namespace palpate {

const std::vector<std::string>& forceFieldMethods() {
  static const std::vector<std::string> methods = {"potential", "trilinear", "tricubic",
                                                   "rbf-linear", "rbf-cubic"};
  return methods;
}

std::unique_ptr<ForceField> makeForceField(std::string_view method, const SpaceTable& space) {
  if (method == "potential") return std::make_unique<PotentialField>(space);
  if (method == "trilinear") return std::make_unique<TrilinearField>(space);
  if (method == "tricubic") return std::make_unique<TricubicField>(space);
  if (method == "rbf-linear") return std::make_unique<RbfField>(space, RbfKernel::linear);
  if (method == "rbf-cubic") return std::make_unique<RbfField>(space, RbfKernel::cubic);
  throw badInput("unknown method \"{}\"; known: {}", method, fmt::join(forceFieldMethods(), ", "));
}

}  // namespace palpate
