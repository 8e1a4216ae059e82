#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "viewer/fields/force_field.hpp"

namespace palpate {

/// The words for makeForceField, the default first.
const std::vector<std::string>& forceFieldMethods();

/// The field that interpolates `space` by a method. Error (bad input) for an unknown method,
/// listing the known; Error when the space has no solved point, or when radial functions cannot be
/// had of its points (rbf_field.hpp). Any thread.
std::unique_ptr<ForceField> makeForceField(std::string_view method, const SpaceTable& space);

}  // namespace palpate
